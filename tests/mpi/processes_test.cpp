/// Runs over several processes: the bits of one, one voice, one end.

#include <gtest/gtest.h>

#include <algorithm>
#include <csignal>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <random>

#include "app/program.hpp"
#include "folder_of_its_own.hpp"
#include "talus/output/checkpoint.hpp"
#include "talus/output/snapshot.hpp"

namespace processes_test {

namespace fs = std::filesystem;
using program::contents, program::Finished, program::has, program::replaced, program::talus;

/// A block of 400 particles that runs over three tiles in 60 ms: it leaves every process that it was dealt out to.
const std::string runaway = R"(title = "A block runs away"
[domain]
kind = "plane_strain"
min = ["-0.4 m", "0 m"]
max = ["1.2 m", "0.4 m"]
cell = "20 mm"
gravity = ["0 m/s2", "-9.81 m/s2"]
[domain.walls]
y_min = "no_slip"
[material.sand]
law = "mohr_coulomb"
E = "1 MPa"
nu = 0.3
c = "0 Pa"
phi = "30 deg"
psi = "0 deg"
density = "1600 kg/m3"
[body.block]
material = "sand"
box = { min = ["-0.1 m", "0 m"], max = ["0.1 m", "0.2 m"] }
spacing = "10 mm"
velocity = ["4 m/s", "0 m/s"]
initial_stress = "zero"
[run]
end = "60 ms"
[output]
snapshots = "20 ms"
history = "1 ms"
pictures = []
checkpoints = "5 ms"
)";

/// Three bodies of two laws; the first pushes the second, the third falls on both. Period: 20 tiles.
std::string bodies_on_periodic_ground() {
  std::string text = replaced(runaway, "gravity = [\"0 m/s2\"", "gravity = [\"3 m/s2\"");
  text = replaced(text, "y_min", "x_min = \"periodic\"\nx_max = \"periodic\"\ny_min");
  return replaced(text, "[run]", R"([material.rubber]
law = "linear_elastic"
E = "0.1 MPa"
nu = 0.3
density = "1000 kg/m3"
[body.hindrance]
material = "rubber"
box = { min = ["0.12 m", "0 m"], max = ["0.22 m", "0.16 m"] }
spacing = "10 mm"
initial_stress = "zero"
[body.roof]
material = "sand"
box = { min = ["-0.2 m", "0.24 m"], max = ["0.2 m", "0.3 m"] }
spacing = "10 mm"
initial_stress = "zero"
[run])");
}

std::string out_of_the_domain() {
  return replaced(replaced(runaway, "y_min", "x_max = \"outflow\"\ny_min"), "max = [\"1.2 m\", \"0.4 m\"]",
                  "max = [\"0.24 m\", \"0.4 m\"]");
}

using State = std::map<std::string, std::vector<double>>;

/// Of the last checkpoint.
State state_in(const fs::path& folder) {
  ::talus::SavedRun last;
  for (const int place : {0, 1}) {
    const fs::path file = ::talus::Checkpoints::file(folder, place);
    if (!fs::exists(file)) continue;
    ::talus::SavedRun saved = ::talus::read_checkpoint(file);
    if (saved.number > last.number) last = std::move(saved);
  }
  return last.state();
}

bool same_bits(const std::vector<double>& a, const std::vector<double>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), a.size() * sizeof(double)) == 0);
}

/// Whether two snapshots have the same particles, bit by bit. The order of datasets in the files may differ.
bool same_snapshots(const fs::path& a, const fs::path& b) {
  const ::talus::Observation one = ::talus::read_snapshot(a), other = ::talus::read_snapshot(b);
  if (one.time != other.time || one.step != other.step || one.fields.size() != other.fields.size()) return false;
  for (const ::talus::Field& f : one.fields) {
    const ::talus::Field* its = f.name == "position" ? &other.fields[0] : other.find(f.name);
    if (!its || its->unit != f.unit || its->meaning != f.meaning || its->components != f.components ||
        !same_bits(f.values, its->values))
      return false;
  }
  return true;
}

/// What is not the same, bit by bit, in two folders of results; empty if nothing.
std::string difference(const fs::path& a, const fs::path& b) {
  for (const auto& entry : fs::directory_iterator(a)) {
    const fs::path name = entry.path().filename();
    if (name.extension() == ".csv" && contents(entry.path()) != contents(b / name)) return name.string();
    if (name.extension() == ".hdf" && !same_snapshots(entry.path(), b / name)) return name.string();
  }
  const State one = state_in(a), other = state_in(b);
  if (one.size() != other.size() || one.empty()) return "arrays of checkpoints";
  for (const auto& [name, values] : one)
    if (!other.contains(name) || !same_bits(values, other.at(name))) return name;
  return "";
}

/// mpirun at work in the background.
class Launched {
 public:
  Launched(int n, const std::vector<std::string>& arguments, fs::path log) : log_(std::move(log)) {
    std::vector<std::string> words{"mpirun", "--oversubscribe", "-n", std::to_string(n), TALUS_PROGRAM};
    words.insert(words.end(), arguments.begin(), arguments.end());
    std::vector<char*> argv;
    for (std::string& w : words) argv.push_back(w.data());
    argv.push_back(nullptr);
    const int out = ::open(log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);  // nobody reads what a run before wrote
    pid_ = ::fork();
    if (pid_ != 0) {
      ::close(out);
      return;
    }
    ::dup2(out, 1);
    ::dup2(out, 2);
    ::execvp("mpirun", argv.data());
    ::_exit(127);
  }
  ~Launched() {
    if (pid_ <= 0) return;
    ::kill(pid_, SIGTERM);
    wait();
  }
  Launched(const Launched&) = delete;
  Launched& operator=(const Launched&) = delete;

  pid_t pid() const { return pid_; }
  /// The processes of talus, by their numbers.
  std::vector<pid_t> processes() const {
    std::ifstream children("/proc/" + std::to_string(pid_) + "/task/" + std::to_string(pid_) + "/children");
    std::vector<pid_t> all;
    for (pid_t p; children >> p;) all.push_back(p);
    return all;
  }
  bool is_over() {
    int status = 0;
    if (pid_ <= 0 || ::waitpid(pid_, &status, WNOHANG) != pid_) return pid_ <= 0;
    end(status);
    return true;
  }
  Finished wait() {
    int status = 0;
    if (pid_ > 0 && ::waitpid(pid_, &status, 0) == pid_) end(status);
    return {code_, contents(log_)};
  }

 private:
  void end(int status) {
    code_ = WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    pid_ = 0;
  }
  pid_t pid_ = 0;
  int code_ = -1;
  fs::path log_;
};

class Processes : public ::talus::FolderOfItsOwn {
 protected:
  void SetUp() override {
    FolderOfItsOwn::SetUp();
    for (const char* name : {"OMPI_ALLOW_RUN_AS_ROOT", "OMPI_ALLOW_RUN_AS_ROOT_CONFIRM"}) ::setenv(name, "1", 1);
  }
  std::string in(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return in(name);
  }
  static Finished on(int n, const std::string& arguments) {
    return talus(arguments, "mpirun --oversubscribe -n " + std::to_string(n));
  }
  /// Runs a case in one process, and in others with their threads; all results must be the same.
  void expect_same_bits(const std::string& file, const std::string& more, std::vector<std::pair<int, int>> how) {
    if (std::getenv("TALUS_ALL_PROCESSES"))
      for (how.clear(); const int threads : {1, 2})
        for (const int n : {2, 3, 5, 8}) how.push_back({n, threads});
    const Finished one = talus("run " + file + " --out " + in("one") + " --threads 1 " + more);
    ASSERT_EQ(one.code, 0) << one.output;
    for (const auto& [n, threads] : how) {
      const std::string out = in(std::to_string(n) + "_" + std::to_string(threads));
      const Finished several =
          on(n, "run " + file + " --out " + out + " --threads " + std::to_string(threads) + " " + more);
      ASSERT_EQ(several.code, 0) << several.output;
      EXPECT_EQ(difference(in("one"), out), "") << n << " processes of " << threads << " threads";
    }
  }
};

TEST_F(Processes, HaveTheBitsOfOneWhenABlockRunsAway) {
  expect_same_bits(write("case.toml", runaway), "", {{2, 1}, {3, 2}, {8, 1}});
}

TEST_F(Processes, HaveTheBitsOfOneWithSeveralBodiesOnPeriodicGround) {
  expect_same_bits(write("case.toml", bodies_on_periodic_ground()), "", {{2, 2}, {5, 1}});
}

TEST_F(Processes, HaveTheBitsOfOneWhenParticlesLeave) {
  expect_same_bits(write("case.toml", out_of_the_domain()), "", {{3, 1}, {5, 2}});
}

TEST_F(Processes, HaveTheBitsOfOneOnTerrain) {
  expect_same_bits(TALUS_SOURCE_DIR "/cases/landslide.toml", "--until '0.4 s'", {{3, 1}});
  for (const auto& entry : fs::directory_iterator(in("one/maps")))
    if (entry.path().extension() == ".asc") {
      EXPECT_EQ(contents(entry.path()), contents(folder_ / "3_1/maps" / entry.path().filename())) << entry;
    }
}

TEST_F(Processes, GoOnFromACheckpointOfAnyNumberOfThem) {
  const std::string file = write("case.toml", bodies_on_periodic_ground());
  ASSERT_EQ(talus("run " + file + " --threads 1 --out " + in("one")).code, 0);
  const auto part = [&](int n, const std::string& until) {
    const std::string arguments = "run " + file + " --resume --threads 1 --out " + in("parts") + " --until " + until;
    const Finished done = n == 1 ? talus(arguments) : on(n, arguments);
    EXPECT_EQ(done.code, 0) << done.output;
  };
  part(1, "'15 ms'");
  part(8, "'30 ms'");
  part(3, "'45 ms'");
  part(1, "'60 ms'");
  EXPECT_EQ(difference(in("one"), in("parts")), "");
}

TEST_F(Processes, SpeakWithOneVoice) {
  const Finished done = on(3, "run " + write("case.toml", runaway) + " --threads 1 --out " + in("out"));
  EXPECT_TRUE(has(done.output, "400 particles, 3 processes of 1 thread")) << done.output;
  EXPECT_EQ(done.output.find("report: "), done.output.rfind("report: ")) << done.output;
  const Finished mistaken = on(3, "run " + write("mistaken.toml", replaced(runaway, "\"30 deg\"", "30")));
  EXPECT_EQ(mistaken.code, 2) << mistaken.output;
  EXPECT_EQ(mistaken.output.find("phi = 30"), mistaken.output.rfind("phi = 30")) << mistaken.output;
  const Finished checked = on(3, "check " + in("case.toml") + " --threads 1");
  EXPECT_EQ(checked.code, 0) << checked.output;
  EXPECT_TRUE(
      has(checked.output, "process   particles   tiles   neighbours   messages a step   kB a step   ms waiting"))
      << checked.output;
}

TEST_F(Processes, ReportAnErrorOfTheRunOnce) {
  // Open on its right, the domain loses a particle of the last process.
  const std::string file = write("leaves.toml", replaced(out_of_the_domain(), "x_max = \"outflow\"\n", ""));
  const Finished one = talus("run " + file + " --threads 1 --out " + in("one")),
                 broken = on(3, "run " + file + " --threads 1 --out " + in("out"));
  EXPECT_EQ(one.code, 3) << one.output;
  EXPECT_EQ(broken.code, 3) << broken.output;
  const std::string said = "a particle has left the domain";
  const std::size_t at = one.output.find(said);
  ASSERT_NE(at, one.output.npos) << one.output;
  EXPECT_TRUE(has(broken.output, one.output.substr(at, one.output.find("The last good", at) - at))) << broken.output;
  EXPECT_TRUE(has(broken.output, "mpirun -n 3 ")) << "the command that shows it again\n" << broken.output;
  EXPECT_TRUE(same_snapshots(in("one/failure.hdf"), in("out/failure.hdf")));
}

TEST_F(Processes, StopAtSigtermWithOneCheckpoint) {
  const std::string file = write("case.toml", replaced(runaway, "\"60 ms\"", "\"600 ms\""));
  Launched run(3, {"run", file, "--threads", "1", "--out", in("out")}, in("log"));
  const auto has_rows = [&] { return contents(in("out/history.csv")).size() > 4000; };
  for (int i = 0; i < 3000 && !has_rows(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  ::kill(run.processes().at(0), SIGTERM);
  const Finished stopped = run.wait();
  EXPECT_EQ(stopped.code, 128 + SIGTERM) << stopped.output;
  EXPECT_TRUE(has(stopped.output, "stopped by SIGTERM")) << stopped.output;
  EXPECT_TRUE(has(stopped.output, "Resume with\n  mpirun -n 3 ")) << stopped.output;
  const State saved = state_in(in("out"));
  EXPECT_TRUE(saved.contains("ledger"));
}

TEST_F(Processes, KilledAtRandomEndAndGoOnWithTheSameBits) {
  const std::string file = write("case.toml", replaced(runaway, "\"60 ms\"", "\"120 ms\""));
  ASSERT_EQ(talus("run " + file + " --threads 1 --out " + in("one")).code, 0);
  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  const char* asked = std::getenv("TALUS_KILLS_OF_PROCESSES");
  const int kills = asked ? std::atoi(asked) : 3;
  double longest = 0;
  int n_told = 0;
  for (int k = 0; k < kills; ++k) {
    if (fs::exists(in("out/report.html"))) fs::remove_all(in("out"));
    const int n = 2 + int(random() % 3);
    Launched run(n, {"run", file, "--resume", "--threads", "1", "--out", in("out")}, in("log"));
    while (!has(contents(in("log")), "results in") && !run.is_over())
      std::this_thread::sleep_for(std::chrono::milliseconds(2));
    std::this_thread::sleep_for(std::chrono::milliseconds(random() % 200));
    const std::vector<pid_t> processes = run.processes();
    if (processes.empty()) {  // it was faster
      --k;
      fs::remove_all(in("out"));
      continue;
    }
    const auto start = std::chrono::steady_clock::now();
    const std::size_t victim = random() % processes.size();
    ::kill(processes[victim], SIGKILL);
    const Finished end = run.wait();
    if (end.code == 0 || fs::exists(in("out/report.html"))) continue;  // it had all its results
    const double seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    longest = std::max(longest, seconds);
    EXPECT_LT(seconds, 30);
    // mpirun does not always pass on what is printed after a process has died, but then says itself which one has.
    const bool is_told = has(end.output, "was killed or has crashed; the run has ended. Resume it with\n  mpirun -n ");
    n_told += is_told;
    EXPECT_TRUE(is_told || has(end.output, "exited on signal 9 (Killed)"))
        << "process " << victim << " of " << n << ":\n"
        << end.output;
  }
  const Finished last = on(2, "run " + file + " --resume --threads 1 --out " + in("out"));
  ASSERT_EQ(last.code, 0) << last.output;
  EXPECT_EQ(difference(in("one"), in("out")), "") << last.output;
  std::printf("%d kills; the run ended within %.2f s, %d times with its last words\n", kills, longest, n_told);
}

}  // namespace processes_test
