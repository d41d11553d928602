/// Runs that stop and go on: by a signal, by a kill, on a full disk, beyond their end.

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <csignal>
#include <filesystem>
#include <fstream>
#include <functional>
#include <random>

#include "app/program.hpp"
#include "folder_of_its_own.hpp"
#include "talus/app/interrupt.hpp"

namespace resume_test {

namespace fs = std::filesystem;
using program::contents, program::Finished, program::has, program::replaced, program::Running, program::talus;

/// 400 particles that slump for about a thousand steps, with a checkpoint every few of them.
const std::string slump = R"(title = "A small column slumps"
[domain]
kind = "plane_strain"
min = ["-0.4 m", "0 m"]
max = ["0.4 m", "0.3 m"]
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
[body.column]
material = "sand"
box = { min = ["-0.1 m", "0 m"], max = ["0.1 m", "0.2 m"] }
spacing = "10 mm"
initial_stress = "k0"
[run]
end = "0.4 s"
[output]
snapshots = "20 ms"
history = "1 ms"
pictures = ["0 s", "0.1 s", "0.3 s"]
checkpoints = "2 ms"
)";

/// The files that hold what a run found out, by name.
std::vector<std::string> data_in(const fs::path& folder) {
  std::vector<std::string> names;
  for (const auto& entry : fs::recursive_directory_iterator(folder)) {
    const std::string extension = entry.path().extension();
    if (extension == ".csv" || extension == ".hdf" || extension == ".series" || extension == ".gp" ||
        extension == ".unfinished")
      names.push_back(fs::relative(entry.path(), folder));
  }
  std::sort(names.begin(), names.end());
  return names;
}
/// What is not the same, byte by byte, in two folders of results; empty if nothing.
std::string difference(const fs::path& a, const fs::path& b) {
  if (data_in(a) != data_in(b)) return "not the same files";
  for (const std::string& name : data_in(a))
    if (contents(a / name) != contents(b / name)) return name;
  return "";
}

void spoil(const fs::path& file, std::size_t at) {
  std::string text = contents(file);
  ASSERT_LT(at, text.size());
  text[at] = char(text[at] ^ 0x10);
  std::ofstream(file) << text;
}

/// The same without pictures, and with fewer checkpoints: for what does not depend on them.
const std::string brief = replaced(replaced(slump, "\"2 ms\"", "\"20 ms\""), R"(["0 s", "0.1 s", "0.3 s"])", "[]");

class Resume : public ::talus::FolderOfItsOwn {
 protected:
  void SetUp() override {
    FolderOfItsOwn::SetUp();
    std::ofstream(folder_ / "slump.toml") << slump;
    std::ofstream(folder_ / "brief.toml") << brief;
  }
  std::string in(const std::string& name) const { return (folder_ / name).string(); }
  std::string write(const std::string& name, const std::string& text) const {
    std::ofstream(folder_ / name) << text;
    return in(name);
  }
  /// Runs the case `brief`.
  Finished run(const std::string& out, const std::string& more = "", const std::string& shell = "") const {
    return talus("run " + in("brief.toml") + " --out " + in(out) + " " + more, shell);
  }
  /// Runs the case `slump`.
  Finished run_slump(const std::string& out, const std::string& more) const {
    return talus("run " + in("slump.toml") + " --out " + in(out) + " " + more);
  }
  /// Starts a run and stops it by a signal when it has written some rows.
  Finished stopped(const std::string& out, int signal, const std::string& threads = "1") const {
    Running slumping({"run", in("slump.toml"), "--out", in(out), "--threads", threads}, in("log"));
    slumping.wait_for(folder_ / out / "history.csv", 20000);
    slumping.send(signal);
    return slumping.wait();
  }
};

TEST_F(Resume, ARunKilledAtRandomMomentsEndsByTheBitsOfAnUnbrokenOne) {
  const auto seconds = [start = std::chrono::steady_clock::now()] {
    return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
  };
  ASSERT_EQ(run_slump("unbroken", "--threads 1").code, 0);
  ASSERT_GT(data_in(folder_ / "unbroken").size(), 20u);
  const double unbroken = seconds();
  talus("--version");
  const double start_up = seconds() - unbroken;

  const unsigned seed = std::random_device{}();
  SCOPED_TRACE("seed " + std::to_string(seed));
  std::mt19937 random(seed);
  std::uniform_real_distribution<double> some(0, 1);
  int kills = 0, while_writing = 0, with_progress = 0, finished = 0;
  std::string before;
  const auto is_writing = [&] {
    return fs::exists(folder_ / "killed/checkpoint_0.h5.unfinished") ||
           fs::exists(folder_ / "killed/checkpoint_1.h5.unfinished");
  };
  while (kills < TALUS_KILLS) {
    for (const char* name : {"killed/checkpoint_0.h5.unfinished", "killed/checkpoint_1.h5.unfinished"})
      fs::remove(folder_ / name);  // left by the kill before; is made anew
    const std::string threads = std::to_string(1 + random() % 3);
    Running slumping({"run", in("slump.toml"), "--out", in("killed"), "--resume", "--threads", threads}, in("log"));
    std::this_thread::sleep_for(std::chrono::duration<double>(start_up + some(random) * unbroken / 20));
    if (kills % 2 == 1)  // every other one strikes as soon as a checkpoint is being written
      for (int i = 0; i < 2000 && !is_writing(); ++i) std::this_thread::sleep_for(std::chrono::microseconds(20));
    slumping.send(SIGKILL);
    const Finished end = slumping.wait();
    if (end.code == 0) {  // it was faster; once more from the start
      ASSERT_EQ(difference(folder_ / "unbroken", folder_ / "killed"), "") << end.output;
      fs::remove_all(folder_ / "killed");
      ++finished;
      continue;
    }
    ASSERT_EQ(end.code, -1) << end.output;
    ++kills;
    while_writing += is_writing();
    with_progress += has(end.output, "resumes from") && end.output != before;
    before = end.output;
  }
  const Finished last = run_slump("killed", "--resume --threads 2");
  ASSERT_EQ(last.code, 0) << last.output;
  EXPECT_EQ(difference(folder_ / "unbroken", folder_ / "killed"), "") << last.output;
  // The kills were meant for runs at work; many must have met one, and some in the middle of a checkpoint.
  EXPECT_GT(with_progress, TALUS_KILLS / 4);
  EXPECT_GT(while_writing, 0);
  std::printf("%d kills, %d of runs that went on, %d while a checkpoint was written; %d runs ended in between\n", kills,
              with_progress, while_writing, finished);
}

TEST_F(Resume, CheckpointsByTheClockComeWhileARunIsAtWorkAndChangeNothing) {
  const std::string file =
      write("clock.toml", replaced(brief, "checkpoints = \"20 ms\"", "checkpoint_wall = \"1 ms\""));
  ASSERT_EQ(run("unbroken").code, 0);
  {
    Running slumping({"run", file, "--out", in("clock")}, in("log"));
    slumping.wait_for(folder_ / "clock/history.csv", 20000);  // 80 rows or so
    slumping.send(SIGKILL);
    EXPECT_EQ(slumping.wait().code, -1);
  }
  const Finished on = talus("run " + in("clock") + " --resume");
  EXPECT_EQ(on.code, 0) << on.output;
  EXPECT_TRUE(has(on.output, "resumes from")) << on.output;
  EXPECT_FALSE(has(on.output, "t = 0 s")) << on.output;
  EXPECT_EQ(difference(folder_ / "unbroken", folder_ / "clock"), "");
}

TEST_F(Resume, ASignalStopsARunThatSaysHowToGoOnAndGoesOnWithOtherThreads) {
  ASSERT_EQ(run_slump("unbroken", "--threads 1").code, 0);
  for (const auto& [signal, name] : {std::pair{SIGINT, "Ctrl-C"}, std::pair{SIGTERM, "SIGTERM"}}) {
    const Finished stop = stopped("stopped", signal);
    EXPECT_EQ(stop.code, 128 + signal) << stop.output;
    EXPECT_TRUE(has(stop.output, std::string("stopped by ") + name)) << stop.output;
    EXPECT_TRUE(has(stop.output, " run " + in("stopped") + " --resume --threads 1")) << stop.output;
    auto record = nlohmann::json::parse(contents(in("stopped/record.json")));
    EXPECT_EQ(record["run"]["outcome"], "stopped");
    const double time = record["run"]["simulated_seconds"], wall = record["run"]["wall_seconds"];

    // the folder alone will do
    const Finished on = talus("run " + in("stopped") + " --resume --threads 3");
    EXPECT_EQ(on.code, 0) << on.output;
    EXPECT_EQ(difference(folder_ / "unbroken", folder_ / "stopped"), "");
    record = nlohmann::json::parse(contents(in("stopped/record.json")));
    EXPECT_EQ(record["run"]["outcome"], "finished");
    EXPECT_EQ(record["run"]["resumed_at_seconds"], std::vector<double>{time});
    EXPECT_GT(record["run"]["wall_seconds"], wall);
    const auto unbroken = nlohmann::json::parse(contents(in("unbroken/record.json")));
    for (const char* part : {"case", "ledger_joule", "time_step", "outline_metre"})
      EXPECT_EQ(record[part], unbroken[part]) << part;
    EXPECT_TRUE(has(contents(in("stopped/report.html")), "1 time, from t = "));
    fs::remove_all(folder_ / "stopped");
  }
}

TEST(Interrupt, TheFirstSignalIsNotedTheSecondKills) {
  EXPECT_EXIT(
      {
        const ::talus::Interrupt interrupt;
        std::raise(SIGINT);
        if (interrupt.signal() == SIGINT) std::raise(SIGTERM);
        std::exit(1);
      },
      testing::KilledBySignal(SIGTERM), "");
}

TEST_F(Resume, DamagedAndForeignCheckpointsAreRefusedAndTheOlderOneIsUsed) {
  ASSERT_EQ(run("unbroken").code, 0);
  ASSERT_EQ(run("stopped", "--until '0.3 s'").code, 0);
  const std::string other = replaced(brief, "phi = \"30 deg\"", "phi = \"31 deg\"");
  ASSERT_EQ(talus("run " + write("other.toml", other) + " --until '5 ms' --out " + in("other")).code, 0);
  fs::path newer = folder_ / "stopped/checkpoint_0.h5", older = folder_ / "stopped/checkpoint_1.h5";
  if (fs::last_write_time(newer) < fs::last_write_time(older)) std::swap(newer, older);
  const std::string whole = contents(newer);
  fs::copy(folder_ / "stopped", folder_ / "kept", fs::copy_options::recursive);

  struct Damage {
    const char* sentence;
    std::function<void()> inflict;
  };
  const std::vector<Damage> damages = {
      {"it is damaged: truncated or changed", [&] { fs::resize_file(newer, whole.size() / 2); }},
      {"it is damaged: truncated or changed", [&] { fs::resize_file(newer, whole.size() - 1); }},
      {"it is damaged: truncated or changed", [&] { spoil(newer, whole.size() / 2); }},
      {"it is damaged: truncated or changed", [&] { spoil(newer, whole.size() - 2); }},
      {"it is no checkpoint of talus", [&] { fs::resize_file(newer, 0); }},
      {"it is no checkpoint of talus", [&] { std::ofstream(newer) << "\x89HDF\r\n\x1a\n and so on"; }},
      {"it is of another format", [&] { std::ofstream(newer) << replaced(whole, "checkpoint 10", "checkpoint 11"); }},
      {"of another case:\n  material.sand.phi was 31 deg, is 30 deg",
       [&] { fs::copy_file(in("other/checkpoint_0.h5"), newer, fs::copy_options::overwrite_existing); }},
  };
  for (const Damage& damage : damages) {
    fs::remove_all(folder_ / "stopped");
    fs::copy(folder_ / "kept", folder_ / "stopped", fs::copy_options::recursive);
    damage.inflict();
    const Finished on = talus("run " + in("stopped") + " --resume --until '0.4 s'");
    EXPECT_EQ(on.code, 0) << on.output;
    EXPECT_TRUE(has(on.output, newer.string() + " cannot be used: ")) << on.output;
    EXPECT_TRUE(has(on.output, damage.sentence)) << on.output;
    EXPECT_TRUE(has(on.output, "resumes from " + older.string())) << on.output;
    EXPECT_EQ(difference(folder_ / "unbroken", folder_ / "stopped"), "");
    // and of the two it was the refused one that made place
    EXPECT_TRUE(has(talus("run " + in("stopped") + " --resume").output, "resumes from ")) << damage.sentence;
  }

  // With none left nothing is touched.
  fs::remove_all(folder_ / "stopped");
  fs::copy(folder_ / "kept", folder_ / "stopped", fs::copy_options::recursive);
  spoil(newer, 100);
  spoil(older, 100);
  const Finished none = talus("run " + in("stopped") + " --resume --until '0.4 s'");
  EXPECT_EQ(none.code, 2) << none.output;
  for (const fs::path& file : {newer, older}) EXPECT_TRUE(has(none.output, file.string() + " cannot be used"));
  EXPECT_EQ(difference(folder_ / "kept", folder_ / "stopped"), "");
}

TEST_F(Resume, AnotherCaseIsRefusedByWhatDiffersAndNothingIsTouched) {
  ASSERT_EQ(run("out", "--until '0.1 s'").code, 0);
  fs::copy(folder_ / "out", folder_ / "kept", fs::copy_options::recursive);
  const std::string other = write(
      "other.toml", replaced(replaced(brief, "phi = \"30 deg\"", "phi = \"31 deg\""), "history = \"1 ms\"\n", ""));
  const Finished resumed = talus("run " + other + " --out " + in("out") + " --resume");
  EXPECT_EQ(resumed.code, 2);
  for (const char* part :
       {"it is of another case", "material.sand.phi was 30 deg, is 31 deg", "output.history was 1 ms, is 0.8 ms"})
    EXPECT_TRUE(has(resumed.output, part)) << part << "\n" << resumed.output;
  const Finished anew = talus("run " + other + " --out " + in("out"));
  EXPECT_EQ(anew.code, 2);
  EXPECT_TRUE(has(anew.output, "holds results already")) << anew.output;
  EXPECT_TRUE(has(anew.output, "run " + in("out") + " --resume")) << anew.output;
  EXPECT_EQ(difference(folder_ / "kept", folder_ / "out"), "");
  EXPECT_EQ(contents(in("kept/case.toml")), contents(in("out/case.toml")));

  // What decides nothing may change: comments, and when checkpoints are made.
  const std::string same = write("same.toml", "# a comment\n" + replaced(brief, "checkpoints = \"20 ms\"", ""));
  EXPECT_EQ(talus("run " + same + " --out " + in("out") + " --resume").code, 0);
  // A folder with somebody else's case but no results is not taken either.
  fs::create_directories(folder_ / "case_only");
  write("case_only/case.toml", other);
  EXPECT_EQ(run("case_only").code, 2);
  EXPECT_EQ(contents(in("case_only/case.toml")), other);
}

TEST_F(Resume, ARunGoesOnBeyondItsEndAsIfItHadNotEnded) {
  ASSERT_EQ(run("unbroken").code, 0);
  // 0.1537 s: neither a row nor a snapshot is due then, but the end has both
  ASSERT_EQ(run("longer", "--until '0.1537 s'").code, 0);
  const Finished early = run("longer", "--resume --until '0.1 s'");
  EXPECT_EQ(early.code, 2);
  EXPECT_TRUE(has(early.output, "--until 0.1 s: the run is at t = 0.15")) << early.output;
  const std::string end = contents(in("longer/history.csv"));
  EXPECT_EQ(run("longer", "--resume").code, 0);  // nothing is left to compute
  EXPECT_EQ(contents(in("longer/history.csv")), end);
  const Finished on = run("longer", "--resume --until '0.4 s'");
  EXPECT_EQ(on.code, 0) << on.output;
  EXPECT_EQ(difference(folder_ / "unbroken", folder_ / "longer"), "");
}

TEST_F(Resume, ARunInSpaceGoesOnWithItsMapAndItsRings) {
  std::string block = replaced(brief, "plane_strain", "3d");
  block = replaced(block, R"(["-0.4 m", "0 m"])", R"(["-0.2 m", "-0.2 m", "0 m"])");
  block = replaced(block, R"(["0.4 m", "0.3 m"])", R"(["0.2 m", "0.2 m", "0.1 m"])");
  block = replaced(block, R"(["0 m/s2", "-9.81 m/s2"])", R"(["0 m/s2", "0 m/s2", "-9.81 m/s2"])");
  block = replaced(block, "y_min", "z_min");
  block = replaced(block, R"({ min = ["-0.1 m", "0 m"], max = ["0.1 m", "0.2 m"] })",
                   R"({ min = ["-0.04 m", "-0.04 m", "0 m"], max = ["0.04 m", "0.04 m", "0.06 m"] })");
  const std::string file = write("block.toml", block);
  const auto run_block = [&](const std::string& out, const std::string& more) {
    const Finished end = talus("run " + file + " --out " + in(out) + " " + more);
    EXPECT_EQ(end.code, 0) << end.output;
  };
  run_block("unbroken", "--until '60 ms'");
  run_block("parts", "--until '30 ms'");
  // Rows later than the checkpoint, as a run that was killed leaves them, go.
  std::ofstream(folder_ / "parts/surface.csv", std::ios::app) << "0.04,0,0,1,1\n";
  std::ofstream(folder_ / "parts/rings.csv", std::ios::app) << "0.04,0,1\n";
  run_block("parts", "--resume --until '60 ms'");
  EXPECT_EQ(difference(folder_ / "unbroken", folder_ / "parts"), "");
  const std::string map = contents(in("unbroken/surface.csv")), rings = contents(in("unbroken/rings.csv"));
  // At the start 4 x 4 patches, 60 mm thick and at rest.
  EXPECT_TRUE(map.starts_with("time [s],x [m],y [m],thickness [m],speed [m/s]\n0,-0.03,-0.03,0.06,0\n")) << map;
  EXPECT_TRUE(rings.starts_with("time [s],radius [m],thickness [m]\n0,0.01,0.0")) << rings;
  EXPECT_TRUE(has(contents(in("unbroken/report.html")), "All instants are in rings.csv."));
  // A run that overwrites these results begins both files anew.
  run_block("unbroken", "--overwrite --until '1 ms'");
  EXPECT_LT(contents(in("unbroken/rings.csv")).size(), rings.size());
}

TEST_F(Resume, WhereNothingIsYetTheRunBegins) {
  ASSERT_EQ(run("unbroken", "--until '0.1 s'").code, 0);
  ASSERT_EQ(run("new", "--resume --until '0.1 s'").code, 0);
  EXPECT_EQ(contents(in("new/history.csv")), contents(in("unbroken/history.csv")));
  // but results without a checkpoint are nobody's to overwrite
  for (const char* name : {"new/checkpoint_0.h5", "new/checkpoint_1.h5"}) fs::remove(folder_ / name);
  const Finished none = run("new", "--resume");
  EXPECT_EQ(none.code, 2);
  EXPECT_TRUE(has(none.output, "holds results but no checkpoint")) << none.output;
  EXPECT_EQ(contents(in("new/history.csv")), contents(in("unbroken/history.csv")));
  EXPECT_EQ(talus("run " + in("new")).code, 2);
  EXPECT_EQ(talus("run " + folder_.string() + " --resume").code, 2);
}

TEST_F(Resume, AFullDiskStopsARunThatLosesNothingAndGoesOnWhenThereIsRoom) {
  ASSERT_EQ(run("unbroken").code, 0);
  // A limit on the size of files, in blocks of 512 bytes, stands for the full disk. It is set by what is larger than
  // everything written before it: here the first checkpoint, or a row of history.csv.
  const auto blocks = [&](const char* file) { return int(fs::file_size(folder_ / "unbroken" / file) / 512); };
  ASSERT_GT(blocks("checkpoint_0.h5"), blocks("particles_0000.hdf") + 8);
  ASSERT_GT(blocks("history.csv"), blocks("checkpoint_0.h5") + 8);
  for (const char* file : {"checkpoint_0.h5", "history.csv"}) {
    fs::remove_all(folder_ / "full");
    const bool has_begun = file == std::string("history.csv");
    const std::string limit = "trap '' XFSZ; ulimit -f " + std::to_string(blocks(file) - 8) + ";";
    const Finished full = run("full", "", limit);
    EXPECT_EQ(full.code, 3) << full.output;
    EXPECT_TRUE(has(full.output, std::string(file) + " cannot be written: File too large")) << full.output;
    EXPECT_EQ(has(full.output, "esume with\n  "), has_begun) << full.output;
    const auto data = data_in(folder_ / "full");
    EXPECT_TRUE(std::none_of(data.begin(), data.end(), [](const auto& name) { return has(name, "unfinished"); }));
    EXPECT_EQ(run("full", "--resume", limit).code, 3);  // as long as it is full
    const Finished on = run("full", "--resume");
    EXPECT_EQ(on.code, 0) << on.output;
    EXPECT_EQ(difference(folder_ / "unbroken", folder_ / "full"), "") << file;
  }
}

TEST_F(Resume, AFolderThatCannotBeWrittenIsSaidAtOnce) {
  write("taken", "a file");
  const Finished file = run("taken");
  EXPECT_EQ(file.code, 2);
  EXPECT_TRUE(has(file.output, "cannot create the folder")) << file.output;
  EXPECT_EQ(contents(in("taken")), "a file");
  // a folder in which even root makes no files
  const Finished system = talus("run " + in("slump.toml") + " --out /proc/self/fdinfo");
  EXPECT_EQ(system.code, 3);
  EXPECT_TRUE(has(system.output, "cannot be written")) << system.output;
}

TEST_F(Resume, TwoRunsDoNotWriteIntoOneFolder) {
  Running first({"run", in("slump.toml"), "--out", in("out"), "--until", "0.2 s"}, in("log"));
  first.wait_for(folder_ / "out/history.csv", 2000);
  for (const char* how : {"--resume", "--overwrite"}) {
    const Finished second = run("out", how);
    EXPECT_EQ(second.code, 2);
    EXPECT_TRUE(has(second.output, "another run is writing into")) << second.output;
  }
  EXPECT_EQ(first.wait().code, 0);
}

TEST_F(Resume, ARunThatBreaksKeepsItsLastCheckpointAndSaysSo) {
  const std::string file =
      write("leaves.toml",
            replaced(brief, "initial_stress = \"k0\"", "initial_stress = \"zero\"\nvelocity = [\"4 m/s\", \"0 m/s\"]"));
  const Finished broken = talus("run " + file + " --out " + in("out"));
  EXPECT_EQ(broken.code, 3);
  EXPECT_TRUE(has(broken.output, "left the domain")) << broken.output;
  EXPECT_TRUE(has(broken.output, "The last checkpoint is " + in("out/checkpoint_"))) << broken.output;
  const Finished again = talus("run " + file + " --out " + in("out") + " --resume");
  EXPECT_EQ(again.code, 3);
  EXPECT_TRUE(has(again.output, "resumes from")) << again.output;
  EXPECT_TRUE(has(again.output, "left the domain")) << again.output;
}

}  // namespace resume_test
