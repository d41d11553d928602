/// Whole steps: how many particles talus moves through a step in a second, for a few cases, on one thread and on several.
///
/// Prints one table. Every measurement is a block of steps that is repeated, and the best block counts: what else runs
/// on a machine can only slow it down. Several threads are compared with one in a line of its own, the median over short
/// blocks in turn, with one thread on each of the cores: cores of a shared machine differ in speed. Rates a CPU-second
/// count the processor time of all threads.

#include <fmt/format.h>
#include <malloc.h>
#include <sched.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <atomic>
#include <chrono>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <thread>
#include <vector>

#include "talus/backend/backend.hpp"
#include "talus/base/machine.hpp"
#include "talus/case/defaults.hpp"
#include "talus/input/read.hpp"
#include "talus/mpm/simulation.hpp"
#include "talus/output/snapshot.hpp"

namespace talus {
namespace {

double wall_seconds() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

// ---- where the time of a step goes -------------------------------------------------------------------------------

/// Parts of a step. A loop belongs to the first of them whose name the type of its body holds: the solver hands its
/// loops to the back end as lambdas, and the name of a lambda's type tells the function it stands in.
struct Phase {
  std::string_view column, function;
};
constexpr Phase phases[] = {
    {"stress", "update_stresses"}, {"move", "move_particles"}, {"order", "sort_by_cell"}, {"nodes", ""}};
constexpr int n_phases = std::size(phases);

/// A loop that runs on as many threads as one asks for at the moment, and notes the time of each phase by the clock: a look
/// at the processor time is a call of the system, which would take a percent of a short step.
class TimedLoop final : public Backend {
 public:
  explicit TimedLoop(int most_threads) : threaded_(make_threads(most_threads)), serial_(make_serial()) {}

  int n_workers() const override { return threaded_->n_workers(); }
  using Backend::for_each;
  void for_each(const Shares& shares, const std::function<void(int, int)>& body) override {
    const double start = wall_seconds();
    (threaded ? threaded_ : serial_)->for_each(shares, body);
    seconds[phase_of(body.target_type())] += wall_seconds() - start;
  }

  bool threaded = false;
  std::array<double, n_phases> seconds{};  ///< since the start

 private:
  int phase_of(const std::type_info& type) {
    for (const auto& [known, phase] : known_)
      if (*known == type) return phase;
    const std::string_view name = type.name();  // mangled, as not every name of a lambda in a lambda can be demangled
    int phase = 0;
    while (name.find(phases[phase].function) == std::string_view::npos) ++phase;
    known_.emplace_back(&type, phase);
    return phase;
  }

  std::unique_ptr<Backend> threaded_, serial_;
  std::vector<std::pair<const std::type_info*, int>> known_;
};

// ---- the cases ---------------------------------------------------------------------------------------------------

struct Benchmark {
  std::string name;
  Case case_;
  int first_steps;  ///< made before the first measurement, so that what is to flow flows
};

/// A box, its corners counted in cells.
struct Cells {
  Index<3> low, high;
};

constexpr const char* elastic = R"(law = "linear_elastic"
E = "10 MPa"
nu = 0.3
density = "2000 kg/m3")";
// Drucker-Prager's cone: Mohr-Coulomb's strength in triaxial compression in every direction.
constexpr const char* cone = R"(law = "mohr_coulomb"
lode = "none"
E = "10 MPa"
nu = 0.3
c = "0 Pa"
phi = "30 deg"
psi = "0 deg"
density = "2000 kg/m3")";

/// A block of ground on a rough base: eight particles in each of its cells of 10 mm.
Case ground(const Cells& domain, const Cells& block, const char* material) {
  const auto corner = [](const Index<3>& i) {
    return fmt::format(R"(["{} mm", "{} mm", "{} mm"])", 10L * i[0], 10L * i[1], 10L * i[2]);
  };
  const std::string text =
      fmt::format(R"(
title = "Ground"
[domain]
kind = "3d"
min = {}
max = {}
cell = "10 mm"
gravity = ["0 m/s2", "0 m/s2", "-9.81 m/s2"]
[domain.walls]
z_min = "no_slip"
[material.ground]
{}
[body.block]
material = "ground"
box = {{ min = {}, max = {} }}
spacing = "5 mm"
initial_stress = "zero"
[run]
end = "1 s"
[output]
snapshots = "1 s"
history = "1 s"
)",
                  corner(domain.low), corner(domain.high), material, corner(block.low), corner(block.high));
  return read_case_text("ground", text).case_;
}

/// A cube that stands free.
Case column_3d(int edge, const char* material) {
  return ground({{-2 * edge, -2 * edge, 0}, {3 * edge, 3 * edge, 2 * edge}}, {{0, 0, 0}, {edge, edge, edge}}, material);
}

Case slump() { return read_case(TALUS_SOURCE_DIR "/cases/slump_2d.toml").case_; }

/// Makes a case one of the slump's grains, which stand in its file, at rest under their weight.
Case of_grains(Case what) {
  const Case beads = slump();
  what.materials[0].law = beads.materials[0].law;
  what.bodies[0].void_ratio = beads.bodies[0].void_ratio;
  what.bodies[0].initial_stress = beads.bodies[0].initial_stress;
  return what;
}

constexpr std::string_view snapshot_column = "granular column, 3D";

std::vector<Benchmark> usual_benchmarks(bool quick) {
  const int edge = quick ? 12 : 24;
  return {{"linear elastic column, 3D", column_3d(edge, elastic), 20},
          {"Drucker-Prager column, 3D", column_3d(edge, cone), quick ? 200 : 500},
          {std::string(snapshot_column), of_grains(column_3d(edge, elastic)), quick ? 300 : 1000},
          {"granular slump, 2D", slump(), quick ? 300 : 1000}};
}

/// The same column in more and more particles: what a particle costs must not grow with their number.
std::vector<Benchmark> growing_columns(bool quick) {
  std::vector<Benchmark> columns;
  for (int edge : {11, 23, 50, 108})  // 1e4, 1e5, 1e6, 1e7 particles
    if (edge < 100 || !quick)
      columns.push_back({fmt::format("granular column, {:.0e}", 8.0 * edge * edge * edge),
                         of_grains(column_3d(edge, elastic)), quick ? 10 : 30});
  return columns;
}

/// The same layer of grains, which slides over its base, in larger and larger domains: neither time nor memory may
/// grow.
std::vector<Benchmark> growing_domains(bool quick) {
  std::vector<Benchmark> domains;
  for (const Index<3>& n : {Index<3>{100, 50, 20},
                            {200, 100, 50},
                            {500, 200, 100},
                            {1000, 500, 200},
                            {1000, 1000, 1000},
                            {10000, 10000, 10000}}) {
    const Cells domain = {{-n[0] / 2, -n[1] / 2, 0}, {n[0] / 2, n[1] / 2, n[2]}};
    Case layer = of_grains(ground(domain, {{-45, -23, 0}, {45, 22, 6}}, elastic));  // 194400 particles
    layer.bodies[0].velocity = {0.3, 0, 0};
    domains.push_back({fmt::format("grains in {:.0e} cells", double(n[0]) * n[1] * n[2]), layer, quick ? 20 : 200});
  }
  return domains;
}

// ---- measurements ------------------------------------------------------------------------------------------------

/// Most memory this process has held since the last `forget_peak` [bytes]; 0 where the system does not tell.
double peak_memory() {
  std::ifstream status("/proc/self/status");
  for (std::string line; std::getline(status, line);)
    if (line.rfind("VmHWM:", 0) == 0) return 1024 * std::stod(line.substr(6));
  return 0;
}
void forget_peak() {
  malloc_trim(0);
  std::ofstream("/proc/self/clear_refs") << 5;  // proc(5): resets the peak of the resident memory
}

struct Measurement {
  double cpu = 1e300, wall = 1e300;  ///< for one step [s]
  std::array<double, n_phases> share{};
};

/// One block of steps.
Measurement measure(Simulation& simulation, TimedLoop& loop, int n_steps) {
  const double cpu = cpu_seconds(), wall = wall_seconds();
  loop.seconds = {};
  for (int i = 0; i < n_steps; ++i) simulation.step();
  Measurement m{cpu_seconds() - cpu, wall_seconds() - wall, loop.seconds};
  for (double& s : m.share) s /= m.wall;
  m.cpu /= n_steps;
  m.wall /= n_steps;
  return m;
}

/// The processors that this process may use.
std::vector<int> processors() {
  cpu_set_t set;
  std::vector<int> all;
  if (sched_getaffinity(0, sizeof set, &set) != 0) return all;
  for (int p = 0; p < CPU_SETSIZE; ++p)
    if (CPU_ISSET(p, &set)) all.push_back(p);
  return all;
}
/// Lets the calling thread run on these only.
void run_on(const std::vector<int>& these) {
  cpu_set_t set;
  CPU_ZERO(&set);
  for (const int p : these) CPU_SET(p, &set);
  sched_setaffinity(0, sizeof set, &set);
}

/// How long a line of the cache takes from one processor to another and back [s], the best of several tries. Cores that share a
/// cache are some times as fast as others, and a virtual machine may be moved from such cores to others at any time.
double seconds_there_and_back(int from, int to) {
  constexpr int n_tries = 5, n_times = 200;
  std::atomic<int> ball = 0;  // each side waits for its own numbers: even ones here, odd ones there
  std::thread other([&] {
    run_on({to});
    for (int k = 1; k < 2 * n_tries * n_times; k += 2) {
      while (ball.load() != k) continue;
      ball.store(k + 1);
    }
  });
  run_on({from});
  double best = 1e300;
  for (int k = 0; k < 2 * n_tries * n_times;) {
    const double start = wall_seconds();
    for (const int end = k + 2 * n_times; k < end; k += 2) {
      ball.store(k + 1);
      while (ball.load() != k + 2) continue;
    }
    best = std::min(best, (wall_seconds() - start) / n_times);
  }
  other.join();
  return best;
}

struct SpeedUp {
  double ratio;                                           ///< of the speed on several threads to that on one
  double distance_least, distance_median, distance_most;  ///< between the processors: there and back [s]
};

/// Median over blocks in turn, each between blocks of one thread on each of the first processors. Before each block two steps
/// bring what other cores have in their caches to those that need it from now on. Nothing if there are fewer processors than
/// threads, or one thread only.
std::optional<SpeedUp> speed_up(Simulation& simulation, TimedLoop& loop, int threads, bool quick) {
  const std::vector<int> all = processors();
  if (threads < 2 || int(all.size()) < threads) return std::nullopt;
  const int n_rounds = quick ? 5 : std::max(5, 50 / threads);
  const double block_seconds = quick ? 0.05 : 0.1;
  loop.threaded = false;
  const int n_steps = std::max(2, int(block_seconds / measure(simulation, loop, 3).wall));
  const auto seconds_a_step = [&](bool threaded) {
    loop.threaded = threaded;
    measure(simulation, loop, 2);
    return measure(simulation, loop, n_steps).wall;
  };
  std::vector<double> ratios, distances;
  for (int round = 0; round < n_rounds; ++round) {
    double rate_of_one = 0, seconds = 0;  // of one thread, mean of the processors; of a step on all threads
    for (int k = 0; k < threads; ++k) {
      run_on({all[std::size_t(k)]});
      rate_of_one += 1 / seconds_a_step(false) / threads;
      run_on({all.front()});  // the other threads go where they find room
      seconds += seconds_a_step(true) / threads;
    }
    ratios.push_back(1 / (seconds * rate_of_one));
    double distance = 0;
    for (int k = 1; k < threads; ++k)
      distance = std::max(distance, seconds_there_and_back(all.front(), all[std::size_t(k)]));
    distances.push_back(distance);
  }
  run_on(all);
  std::sort(ratios.begin(), ratios.end());
  std::sort(distances.begin(), distances.end());
  const std::size_t middle = std::size_t(n_rounds / 2);
  return SpeedUp{ratios[middle], distances.front(), distances[middle], distances.back()};
}

void print_head() {
  fmt::print("talus {}, {}, on {} x {}\n\n", version(), build(), n_processors(), processor());
  fmt::print("{:<27}{:>11}{:>9}{:>13}{:>13}{:>10}{:>10}{:>10}{:>9}  share of time [%]\n", "", "", "", "M particle-",
             "steps per", "ms a", "CPU ns a", "bytes a", "MB at");
  fmt::print("{:<27}{:>11}{:>9}{:>13}{:>13}{:>10}{:>10}{:>10}{:>9}", "case", "particles", "threads", "CPU-second",
             "second", "step", "p.-step", "particle", "most");
  for (const Phase& phase : phases) fmt::print("{:>8}", phase.column);
  fmt::print("{:>8}\n", "rest");
}

/// One alone, and several if asked for.
std::vector<int> numbers_of_threads(int most) { return most > 1 ? std::vector{1, most} : std::vector{1}; }

void run(const Benchmark& benchmark, bool quick, int most_threads) {
  constexpr int n_blocks = 7;
  const double block_seconds = quick ? 0.2 : 1;
  forget_peak();
  TimedLoop loop(most_threads);
  const auto simulation = make_simulation(benchmark.case_, loop);
  loop.threaded = most_threads > 1;
  measure(*simulation, loop, benchmark.first_steps);
  const double n = double(simulation->n_particles());
  const int n_steps = std::max(2, int(block_seconds / measure(*simulation, loop, 5).cpu));

  Measurement best[2];
  for (int block = 0; block < n_blocks; ++block)
    for (int threads : numbers_of_threads(most_threads)) {
      loop.threaded = threads > 1;
      const Measurement m = measure(*simulation, loop, n_steps);
      Measurement& b = best[threads > 1];
      if (m.wall < b.wall) {
        b.wall = m.wall;
        b.share = m.share;
      }
      b.cpu = std::min(b.cpu, m.cpu);
    }
  for (int threads : numbers_of_threads(most_threads)) {
    const Measurement& m = best[threads > 1];
    fmt::print("{:<27}{:>11.0f}{:>9}{:>13.3f}{:>13.3f}{:>10.3g}{:>10.0f}{:>10.0f}{:>9.0f}", benchmark.name, n, threads,
               1e-6 * n / m.cpu, 1e-6 * n / m.wall, 1e3 * m.wall, 1e9 * m.cpu / n, double(simulation->bytes()) / n,
               1e-6 * peak_memory());
    double rest = 1;
    for (double share : m.share) {
      fmt::print("{:>8.0f}", 100 * share);
      rest -= share;
    }
    fmt::print("{:>8.0f}\n", 100 * rest);
    std::fflush(stdout);
  }
  if (const auto s = speed_up(*simulation, loop, most_threads, quick))
    fmt::print("{:<27}{:>20} x {:.2f}; between the cores and back: {:.0f} ns ({:.0f} to {:.0f})\n", "",
               fmt::format("{} threads over one:", most_threads), s->ratio, 1e9 * s->distance_median,
               1e9 * s->distance_least, 1e9 * s->distance_most);
  std::fflush(stdout);
}

/// What snapshots add to the time of steps: blocks of steps with one, the wait for its end included, beside blocks
/// without.
void run_with_snapshots(const Benchmark& benchmark, int most_threads) {
  constexpr int n_blocks = 3, every = 100;
  TimedLoop loop(most_threads);
  const auto simulation = make_simulation(benchmark.case_, loop);
  loop.threaded = most_threads > 1;
  measure(*simulation, loop, benchmark.first_steps);
  const auto folder = std::filesystem::temp_directory_path() / fmt::format("talus_steps_{}", ::getpid());
  std::filesystem::create_directories(folder);
  SnapshotSeries snapshots(folder, default_fields(benchmark.case_));

  fmt::print("\n{}, with a snapshot every {} steps beside none:\n", benchmark.name, every);
  for (int threads : numbers_of_threads(most_threads)) {
    loop.threaded = threads > 1;
    Measurement without, with;
    for (int block = 0; block < n_blocks; ++block) {
      const Measurement plain = measure(*simulation, loop, every);
      without.cpu = std::min(without.cpu, plain.cpu);
      without.wall = std::min(without.wall, plain.wall);
      const double cpu = cpu_seconds(), wall = wall_seconds();
      snapshots.add(simulation->observe());
      measure(*simulation, loop, every);
      snapshots.finish();
      with.cpu = std::min(with.cpu, (cpu_seconds() - cpu) / every);
      with.wall = std::min(with.wall, (wall_seconds() - wall) / every);
    }
    fmt::print(
        "  {} thread{:<3}{:>10.3g} ms a step beside {:.3g} ({:+.1f} %), CPU {:.3g} ms beside {:.3g} ({:+.1f} %)\n",
        threads, threads == 1 ? "" : "s", 1e3 * with.wall, 1e3 * without.wall, 100 * (with.wall / without.wall - 1),
        1e3 * with.cpu, 1e3 * without.cpu, 100 * (with.cpu / without.cpu - 1));
    std::fflush(stdout);
  }
  fmt::print("  a snapshot has {:.3g} MB\n", 1e-6 * double(std::filesystem::file_size(snapshots.last())));
  std::filesystem::remove_all(folder);
}

// ---- what to run -------------------------------------------------------------------------------------------------

struct Options {
  std::vector<Benchmark> (*benchmarks)(bool quick) = usual_benchmarks;
  bool quick = false;
  int threads = 2;   ///< beside one
  std::string only;  ///< runs those whose name contains it
};

constexpr const char* usage = R"(usage: talus_steps [--growth | --domain] [--only TEXT] [--threads N] [--quick]

  --growth      a granular column of 1e4 to 1e7 particles (with --quick to 1e6)
  --domain      the same grains in domains of 1e5 to 1e12 cells
  --only TEXT   only what has TEXT in its name
  --threads N   on N threads beside one, without it on two; with 1, on one only
  --quick       smaller and shorter
)";

/// Nothing if the arguments are wrong.
std::optional<Options> options_of(int argc, char** argv) {
  Options options;
  for (int i = 1; i < argc; ++i) {
    const std::string_view argument = argv[i];
    if (argument == "--quick")
      options.quick = true;
    else if (argument == "--growth")
      options.benchmarks = growing_columns;
    else if (argument == "--domain")
      options.benchmarks = growing_domains;
    else if (argument == "--only" && i + 1 < argc)
      options.only = argv[++i];
    else if (argument == "--threads" && i + 1 < argc && std::atoi(argv[i + 1]) > 0)
      options.threads = std::atoi(argv[++i]);
    else
      return std::nullopt;
  }
  return options;
}

}  // namespace
}  // namespace talus

int main(int argc, char** argv) {
  using namespace talus;
  const std::optional<Options> options = options_of(argc, argv);
  if (!options) {
    fmt::print(stderr, "{}", usage);
    return 2;
  }
  const std::vector<Benchmark> all = options->benchmarks(options->quick);
  std::vector<const Benchmark*> chosen;
  for (const Benchmark& benchmark : all)
    if (benchmark.name.find(options->only) != std::string::npos) chosen.push_back(&benchmark);
  if (chosen.empty()) {
    fmt::print(stderr, "talus_steps: no name contains `{}`; there are\n", options->only);
    for (const Benchmark& benchmark : all) fmt::print(stderr, "  {}\n", benchmark.name);
    return 2;
  }
  print_head();
  for (const Benchmark* benchmark : chosen) run(*benchmark, options->quick, options->threads);
  for (const Benchmark* benchmark : chosen)
    if (benchmark->name == snapshot_column) run_with_snapshots(*benchmark, options->threads);
}
