/// A run in space keeps its particles, and goes on from its checkpoint, however many it has. `TALUS_POINTS=1e8` runs it with so
/// many, on all processors, and prints the memory and time that it takes; `TALUS_NUMBERS=2.15e9` makes an array of so many.
/// docs/many_machines.md has the results.

#include "talus/output/checkpoint.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <chrono>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <map>
#include <numeric>
#include <string>
#include <string_view>
#include <vector>

#include "folder_of_its_own.hpp"
#include "mpm/cases.hpp"
#include "talus/backend/backend.hpp"
#include "talus/mpm/data/particles.hpp"

namespace talus::checkpoint_test {

/// An elastic block of at least so many points, 4 x 4 x 4 in a cell, that slides along a floor. It moves more than a tenth of a
/// cell in a step, so that particles are put in order in every step.
Case sliding_block(double n_points) {
  Case what = block(3, rubber(), 1000);
  const int n = 4 * std::max(1, int(std::cbrt(n_points) / 4)), layers = int(std::ceil(n_points / n / n));
  what.bodies[0].spacing = what.cell / 4;
  what.bodies[0].velocity = {8, 0, 0};
  const double edge = n * what.bodies[0].spacing, height = layers * what.bodies[0].spacing;
  what.bodies[0].region = Box{{0, 0, 0}, {edge, edge, height}};
  what.walls.fill(WallKind::slip);
  what.n_cells = {n / 4 + 4, n / 4, (layers + 3) / 4 + 1};
  for (int a = 0; a < 3; ++a) what.domain.max[a] = what.cell * what.n_cells[a];
  what.domain.min = {};
  what.numerics.transfer = Transfer::flip;
  return what;
}

/// Prints what a part of a run has taken, if it is one by hand.
class Meter {
 public:
  Meter(bool prints, double n) : prints_(prints), n_(n) {}
  void lap(const char* what) {
    const auto now = std::chrono::steady_clock::now();
    std::ifstream status("/proc/self/status");
    double peak = 0, now_held = 0;  // [kB]
    for (std::string line; std::getline(status, line);) {
      if (line.starts_with("VmHWM:")) peak = std::atof(line.c_str() + 6);
      if (line.starts_with("VmRSS:")) now_held = std::atof(line.c_str() + 6);
    }
    if (prints_)
      std::printf("%-28s %6.0f s, at most %4.0f bytes a point, then %4.0f\n", what,
                  std::chrono::duration<double>(now - since_).count(), 1024 * peak / n_, 1024 * now_held / n_);
    std::fflush(stdout);
    std::ofstream("/proc/self/clear_refs") << "5";  // the peak begins anew
    since_ = std::chrono::steady_clock::now();
  }

 private:
  bool prints_;
  double n_;
  std::chrono::steady_clock::time_point since_ = std::chrono::steady_clock::now();
};

/// A hash of the bits of each array of the state.
std::map<std::string, std::size_t> hashes_of(const Simulation& simulation) {
  std::map<std::string, std::size_t> all;
  for (const StateArray& array : simulation.save()) {
    const std::vector<double> values = array.part();
    all[array.name] =
        std::hash<std::string_view>()({reinterpret_cast<const char*>(values.data()), values.size() * sizeof(double)});
  }
  return all;
}

/// Every id from 0 on is there once, all mass is, and nothing is outside the domain.
void expect_all_there(const Simulation& simulation, const Case& what) {
  const auto n = std::size_t(simulation.n_particles());
  for (const StateArray& array : simulation.save()) {
    if (array.name == "body 0: ids 0") {
      std::vector<char> seen(n, 0);
      for (const double number : array.part()) {
        const std::size_t id = std::bit_cast<ParticleIds>(number).id;
        ASSERT_LT(id, n);
        ++seen[id];
      }
      for (const char times : seen) ASSERT_EQ(times, 1);
    }
    if (array.name == "body 0: mass 0") {
      double mass = 0;
      for (const double m : array.part()) mass += m;
      const Box& box = std::get<Box>(what.bodies[0].region);
      EXPECT_NEAR(mass / (1000 * box.max[0] * box.max[1] * box.max[2]), 1, 1e-9);
      EXPECT_NEAR(simulation.ledger().mass / mass, 1, 1e-9);
    }
    for (int a = 0; a < 3; ++a) {
      if (array.name != "body 0: position " + std::to_string(a)) continue;
      for (const double x : array.part()) ASSERT_TRUE(x >= what.domain.min[a] && x <= what.domain.max[a]) << x;
    }
  }
}

class ARunInSpace : public FolderOfItsOwn {};

TEST_F(ARunInSpace, KeepsItsParticlesAndGoesOnFromItsCheckpointWithTheSameBits) {
  const char* by_hand = std::getenv("TALUS_POINTS");
  const double n = by_hand ? std::atof(by_hand) : 3e4;
  const Case what = sliding_block(n);
  const auto threads = make_threads(by_hand ? 0 : 2);
  Meter meter(by_hand, n);
  std::map<std::string, std::size_t> unbroken;
  {
    const auto simulation = make_simulation(what, *threads);
    EXPECT_GE(double(simulation->n_particles()), n);
    meter.lap("filled and put in order");
    for (int i = 0; i < 2; ++i) simulation->step();
    meter.lap("two steps");
    expect_all_there(*simulation, what);
    meter.lap("looked through");
    Checkpoints(folder_, nullptr).write({}, simulation->save());
    meter.lap("checkpoint written");
    simulation->step();
    unbroken = hashes_of(*simulation);
    meter.lap("a step more, and hashes");
  }
  const auto simulation = make_simulation(what, *threads);
  simulation->restore(read_checkpoint(Checkpoints::file(folder_, 0)).arrays());
  meter.lap("filled again, and resumed");
  simulation->step();
  EXPECT_EQ(hashes_of(*simulation), unbroken);
  meter.lap("a step more, and hashes");
}

class AnArrayOfACheckpoint : public FolderOfItsOwn {};

TEST_F(AnArrayOfACheckpoint, IsReadAsItWasWrittenHoweverLongItIs) {
  const char* by_hand = std::getenv("TALUS_NUMBERS");
  const auto n = std::size_t(by_hand ? std::atof(by_hand) : 3e6);
  Meter meter(by_hand, double(n));
  const StateArray numbers{"numbers", n, 0, [&] {
                             std::vector<double> all(n);
                             std::iota(all.begin(), all.end(), 0.5);
                             return all;
                           }};
  Checkpoints(folder_, nullptr).write({}, {numbers});
  meter.lap("written");
  const ReadArray read = read_checkpoint(Checkpoints::file(folder_, 0)).arrays();
  meter.lap("checksum");
  constexpr std::size_t piece = 1 << 20;
  for (std::size_t first = 0; first < n; first += piece) {
    const std::vector<double> some = read("numbers", first, piece);
    ASSERT_EQ(some.size(), std::min(piece, n - first));
    for (std::size_t i = 0; i < some.size(); ++i) ASSERT_EQ(some[i], double(first + i) + 0.5);
  }
  EXPECT_TRUE(read("numbers", n, piece).empty());
  meter.lap("read");
}

}  // namespace talus::checkpoint_test
