/// Whole steps: how many particles talus moves through a step in a second, for a few cases, on one thread and on two.
///
/// Prints one table. Every measurement is a block of steps that is repeated, and the best block counts: what else runs
/// on a machine can only slow it down. Rates a CPU-second count the processor time of all threads; for them to mean
/// work, threads that wait must sleep (OMP_WAIT_POLICY=passive, as `./dev bench` sets it).

#include <cxxabi.h>
#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cstdlib>
#include <memory>
#include <string>
#include <string_view>
#include <vector>

#include "talus/backend/backend.hpp"
#include "talus/base/machine.hpp"
#include "talus/case/read.hpp"
#include "talus/mpm/simulation.hpp"

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
    {"stress", "update_stresses"}, {"move", "move_particles"}, {"order", "put_in_cell_order"}, {"nodes", ""}};
constexpr int n_phases = std::size(phases);

/// A loop that runs on as many threads as one asks for at the moment, and notes the processor time of each phase.
class TimedLoop final : public Loop {
 public:
  explicit TimedLoop(int most_threads) : threaded_(make_openmp(most_threads)), serial_(make_serial()) {}

  int n_workers() const override { return threaded_->n_workers(); }
  using Loop::for_each;
  void for_each(const Shares& shares, const std::function<void(int, int)>& body) override {
    const double start = cpu_seconds();
    (threaded ? threaded_ : serial_)->for_each(shares, body);
    seconds[phase_of(body.target_type())] += cpu_seconds() - start;
  }

  bool threaded = false;
  std::array<double, n_phases> seconds{};  ///< processor time since the start

 private:
  int phase_of(const std::type_info& type) {
    for (const auto& [known, phase] : known_)
      if (*known == type) return phase;
    int status = 0;
    char* name = abi::__cxa_demangle(type.name(), nullptr, nullptr, &status);
    int phase = 0;
    while (std::string_view(status == 0 ? name : "").find(phases[phase].function) == std::string_view::npos) ++phase;
    std::free(name);
    known_.emplace_back(&type, phase);
    return phase;
  }

  std::unique_ptr<Loop> threaded_, serial_;
  std::vector<std::pair<const std::type_info*, int>> known_;
};

// ---- the cases ---------------------------------------------------------------------------------------------------

struct Benchmark {
  std::string name;
  Case what;
  int first_steps;  ///< made before the first measurement, so that what is to flow flows
};

/// A column that stands free on a rough base: a cube of `edge`^3 cells of 10 mm with eight particles each.
Case column_3d(int edge, const std::string& material) {
  const std::string text = fmt::format(
      R"(
title = "A column"
[domain]
kind = "3d"
min = ["{0} mm", "{0} mm", "0 mm"]
max = ["{1} mm", "{1} mm", "{2} mm"]
cell = "10 mm"
gravity = ["0 m/s2", "0 m/s2", "-9.81 m/s2"]
[domain.walls]
z_min = "no_slip"
[material.ground]
{3}
[body.column]
material = "ground"
box = {{ min = ["0 mm", "0 mm", "0 mm"], max = ["{4} mm", "{4} mm", "{4} mm"] }}
spacing = "5 mm"
initial_stress = "zero"
[run]
end = "1 s"
[output]
snapshots = "1 s"
history = "1 s"
)",
      -20 * edge, 30 * edge, 20 * edge, material, 10 * edge);
  return read_case_text("column", text).what;
}

std::vector<Benchmark> all_benchmarks(bool quick) {
  const int edge = quick ? 12 : 24;
  const std::string elastic = R"(law = "linear_elastic"
E = "10 MPa"
nu = 0.3
density = "2000 kg/m3")";
  // Drucker-Prager's cone: Mohr-Coulomb's strength in triaxial compression in every direction.
  const std::string cone = R"(law = "mohr_coulomb"
lode = "none"
E = "10 MPa"
nu = 0.3
c = "0 Pa"
phi = "30 deg"
psi = "0 deg"
density = "2000 kg/m3")";
  // The grains of the slump stand in its case.
  const Case slump = read_case(TALUS_SOURCE_DIR "/cases/slump_2d.toml").what;
  Case grains = column_3d(edge, elastic);
  grains.materials[0].law = slump.materials[0].law;
  grains.bodies[0].void_ratio = slump.bodies[0].void_ratio;
  grains.bodies[0].initial_stress = slump.bodies[0].initial_stress;

  return {{"linear elastic column, 3D", column_3d(edge, elastic), 20},
          {"Drucker-Prager column, 3D", column_3d(edge, cone), quick ? 200 : 500},
          {"granular column, 3D", grains, quick ? 300 : 1000},
          {"granular slump, 2D", slump, quick ? 300 : 1000}};
}

// ---- measurements ------------------------------------------------------------------------------------------------

struct Measurement {
  double cpu = 1e300, wall = 1e300;  ///< for one particle and step [s]
  std::array<double, n_phases> share{};
};

/// One block of steps.
Measurement measure(Simulation& simulation, TimedLoop& loop, int n_steps) {
  const double cpu = cpu_seconds(), wall = wall_seconds();
  loop.seconds = {};
  for (int i = 0; i < n_steps; ++i) simulation.step();
  Measurement m{cpu_seconds() - cpu, wall_seconds() - wall, loop.seconds};
  for (double& s : m.share) s /= m.cpu;
  const double particle_steps = double(simulation.n_particles()) * n_steps;
  m.cpu /= particle_steps;
  m.wall /= particle_steps;
  return m;
}

void run(const Benchmark& benchmark, bool quick) {
  constexpr int n_blocks = 7;
  const double block_seconds = quick ? 0.2 : 1;
  TimedLoop loop(2);
  const auto simulation = make_simulation(benchmark.what, loop);
  loop.threaded = true;
  measure(*simulation, loop, benchmark.first_steps);
  const double n = double(simulation->n_particles());
  const int n_steps = std::max(2, int(block_seconds / (n * measure(*simulation, loop, 5).cpu)));

  Measurement best[2];
  for (int block = 0; block < n_blocks; ++block)
    for (int threads : {1, 2}) {
      loop.threaded = threads > 1;
      const Measurement m = measure(*simulation, loop, n_steps);
      Measurement& b = best[threads - 1];
      if (m.cpu < b.cpu) {
        b.cpu = m.cpu;
        b.share = m.share;
      }
      b.wall = std::min(b.wall, m.wall);
    }
  for (int threads : {1, 2}) {
    const Measurement& m = best[threads - 1];
    fmt::print("{:<27}{:>11.0f}{:>9}{:>13.3f}{:>13.3f}{:>10.0f}{:>10.0f}", benchmark.name, n, threads, 1e-6 / m.cpu,
               1e-6 / m.wall, 1e9 * m.cpu, double(simulation->bytes()) / n);
    double rest = 1;
    for (double share : m.share) {
      fmt::print("{:>8.0f}", 100 * share);
      rest -= share;
    }
    fmt::print("{:>8.0f}\n", 100 * rest);
    std::fflush(stdout);
  }
}

}  // namespace
}  // namespace talus

int main(int argc, char** argv) {
  using namespace talus;
  const bool quick = argc == 2 && std::string_view(argv[1]) == "--quick";
  if (argc > 1 && !quick) {
    fmt::print(stderr, "usage: talus_steps [--quick]\n");
    return 2;
  }
  fmt::print("talus {}, {}, on {} x {}\n\n", version(), build(), n_processors(), processor());
  fmt::print("{:<27}{:>11}{:>9}{:>13}{:>13}{:>10}{:>10}  share of CPU time [%]\n", "", "", "", "M particle-",
             "steps per", "CPU ns a", "bytes a");
  fmt::print("{:<27}{:>11}{:>9}{:>13}{:>13}{:>10}{:>10}", "case", "particles", "threads", "CPU-second", "second",
             "p.-step", "particle");
  for (const Phase& phase : phases) fmt::print("{:>8}", phase.column);
  fmt::print("{:>8}\n", "rest");
  for (const Benchmark& benchmark : all_benchmarks(quick)) run(benchmark, quick);
}
