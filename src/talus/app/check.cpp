#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>

#include "talus/app/commands.hpp"
#include "talus/app/processes.hpp"
#include "talus/app/progress.hpp"
#include "talus/app/rehearsal.hpp"
#include "talus/app/task.hpp"
#include "talus/app/threads.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"
#include "talus/input/read.hpp"
#include "talus/mpm/simulation.hpp"
#include "talus/mpm/start/plausibility.hpp"
#include "talus/output/history.hpp"
#include "talus/output/notices.hpp"
#include "talus/output/outline.hpp"
#include "talus/output/picture.hpp"
#include "talus/output/plot.hpp"
#include "talus/output/snapshot.hpp"
#include "talus/output/surface_forces.hpp"
#include "talus/output/terrain_maps.hpp"

namespace talus {

namespace {

void print_understood(const std::vector<Understood>& understood) {
  std::size_t path = 0, value = 0;
  for (const Understood& u : understood) {
    path = std::max(path, u.path.size());
    value = std::max(value, std::min<std::size_t>(u.value.size(), 36));
  }
  for (const Understood& u : understood)
    fmt::print("  {:<{}}  {:<{}}  {}{}\n", u.path, path, u.value, value, u.by_default ? "[default] " : "", u.meaning);
}

class Clock {
 public:
  double seconds() const { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count(); }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

/// Mean time of a call that is repeated for a while, so that one hiccup of the machine does not count [s].
template <class F>
double mean_time(F f) {
  constexpr double a_while = 0.2;
  const Clock clock;
  int n = 0;
  do {
    f();
    ++n;
  } while (clock.seconds() < a_while && n < 100);
  return clock.seconds() / n;
}

/// Times of writing a row, a snapshot, and pictures and charts at the end [s].
struct OutputTimes {
  double row, snapshot, end;
};

/// Writes rows, snapshots and pictures of the start of a run into a temporary folder.
OutputTimes measure_output(const Case& case_, Simulation& simulation) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / fmt::format("talus_check_{}", ::getpid());
  fs::create_directories(folder);
  OutputTimes times{};
  const OutlineFinder outlines(case_, simulation.places());
  History history(folder / "history.csv", case_);
  SurfaceForces forces(case_);
  times.row = mean_time([&] { history.add(simulation.ledger(), outlines.find(simulation.places()), forces.row()); });
  Observation seen;
  times.snapshot = mean_time([&] {
    seen = simulation.observe();
    write_snapshot(folder / "particles.hdf", seen, *case_.output.fields);
  });
  history.add(simulation.ledger(), outlines.find(simulation.places()),
              forces.row());  // a curve has two points at least
  PictureBook pictures(folder / "pictures", case_);
  const auto draw_one_more = [&] {
    pictures.add(seen);
    const Clock clock;
    pictures.draw();
    return clock.seconds();
  };
  if (const std::size_t n = case_.output.pictures->size(); n > 0) {  // the first instant includes the start of gnuplot
    const double one = draw_one_more(), two = draw_one_more();
    times.end = one + std::max(0.0, two - one) * double(n - 1);
  }
  const Clock clock_of_charts;
  for (const Chart& chart : charts_of(history, length_unit_for(extent(case_))))
    if (!draw_chart(folder / "pictures", folder / "history.csv", chart)) break;
  times.end += clock_of_charts.seconds();
  fs::remove_all(folder);
  return times;
}

void print_notices(const Case& case_) {
  for (const std::string& notice : {notice_of_stiffness(case_.numerics), notice_of_preset(case_)})
    if (!notice.empty()) fmt::print("\nwarning: {}\n", notice);
  for (const std::string& doubt : doubts_about(case_)) fmt::print("\nwarning: {}\n", doubt);
  if (const std::string notice = notice_of_symmetry(case_); !notice.empty()) fmt::print("\n  {}\n", notice);
}

void print_sizes(const Case& case_, const Simulation& simulation) {
  const double cells = double(case_.n_cells[0]) * case_.n_cells[1] * (case_.dim == 3 ? case_.n_cells[2] : 1);
  fmt::print(
      "\n  particles           {}\n  cells               {:.0f}, {} of them near particles\n  first stable step   "
      "{:.3g} s\n",
      simulation.n_particles(), cells, simulation.n_tiles() * (case_.dim == 3 ? 64 : 16), simulation.next_dt());
  if (case_.numerics.dt && *case_.numerics.dt > 0) fmt::print("  fixed step          {:.3g} s\n", *case_.numerics.dt);
}

/// Time of a step on this machine, measured on steps of this very case for a second [s].
double measure_step(const Case& case_, Simulation& simulation) {
  const Clock clock;
  while (clock.seconds() < 1 && simulation.ledger().time < case_.end) simulation.step();
  return clock.seconds() / double(std::max(1L, simulation.ledger().step));
}

/// What each process holds, and what it has sent since `before` in every step. Nothing of a single process.
void print_loads(const Simulation& simulation, const std::vector<Processes::Load>& before) {
  const std::vector<Processes::Load> loads = processes().loads(simulation);
  if (loads.empty()) return;
  fmt::print("  process   particles   tiles   neighbours   messages a step   kB a step   ms waiting a step\n");
  const double steps = double(std::max(1L, simulation.ledger().step));
  for (std::size_t o = 0; o < loads.size(); ++o) {
    const auto& [share, traffic] = loads[o];
    fmt::print("  {:7}   {:9}   {:5}   {:10}   {:15.1f}   {:9.1f}   {:17.3f}\n", o, share.n_particles, share.n_tiles,
               share.n_neighbours, double(traffic.n_messages - before[o].traffic.n_messages) / steps,
               1e-3 * double(traffic.n_bytes - before[o].traffic.n_bytes) / steps,
               1e3 * (traffic.seconds - before[o].traffic.seconds) / steps);
  }
}

/// How many steps a run will make, and how that was found.
struct ExpectedSteps {
  double n;
  std::string how;
};
ExpectedSteps expect_steps(const Case& case_, Backend& loop, double first_dt, double per_step) {
  if (case_.numerics.dt) {
    const double n = case_.end / *case_.numerics.dt;
    return {n, fmt::format("{:.0f}, of fixed length", n)};
  }
  const Rehearsal rehearsal = rehearse(case_, loop, case_.end / first_dt * per_step, 1);
  return {rehearsal.steps,
          fmt::format("about {:.3g} (extrapolated from a trial run{} to t = {:.3g} s)", rehearsal.steps,
                      rehearsal.coarser == 1 ? "" : fmt::format(" on cells {} times coarser", rehearsal.coarser),
                      rehearsal.until)};
}

/// Draws the terrain with the release in a folder beside the user, and says where.
void print_map(const Case& case_, const std::string& case_file) {
  namespace fs = std::filesystem;
  const fs::path png = fs::path(fs::path(case_file).stem().string() + "_map") / "map.png";
  fs::create_directories(png.parent_path());
  if (draw_case_map(png, case_))
    fmt::print("map: {}\n", fs::absolute(png).string());
  else
    fmt::print("no map was drawn: gnuplot is not installed\n");
}

}  // namespace

int check_case(const CheckOptions& options) {
  const std::string& case_file = options.case_file;
  const std::vector<Override> overrides = read_overrides(options.set);
  const CaseFile input = read_case(case_file, overrides);
  const Case& case_ = input.case_;
  fmt::print("{}: settings\n", case_file);
  print_understood(input.understood);
  print_notices(case_);

  expect_memory_for(case_);
  const int threads = usable_threads(options.threads, options.force_threads);
  const auto loop = processes().make_backend(threads);
  auto simulation = processes().make_simulation(case_, case_file,
                                                with_overrides(case_file, contents_of(case_file), overrides), *loop);
  const double first_dt = simulation->next_dt(), n_particles = double(simulation->n_particles());
  print_sizes(case_, *simulation);
  const std::vector<Processes::Load> before = processes().loads(*simulation);
  const double per_step = measure_step(case_, *simulation);
  print_loads(*simulation, before);
  const std::size_t bytes = simulation->bytes();
  const OutputTimes output = measure_output(case_, *simulation);
  const long tried = simulation->ledger().step;
  ExpectedSteps steps{double(tried), fmt::format("{}, counted in a run to the end", tried)};
  if (simulation->ledger().time < case_.end) {
    simulation.reset();  // makes room for another one
    steps = expect_steps(case_, *make_threads(threads), first_dt, per_step);
  }
  const auto instants = [&](double interval) { return std::min(steps.n, case_.end / interval) + 1; };
  const double duration = steps.n * per_step + instants(*case_.output.history) * output.row +
                          instants(*case_.output.snapshots) * output.snapshot + output.end;
  fmt::print(
      "  expected steps      {}\n  memory              {:.3g} MB\n  speed here          {:.3g} M "
      "particle-steps/s on {}{} thread{}\n  expected duration   {}\n",
      steps.how, 1e-6 * double(bytes), 1e-6 * n_particles / per_step,
      processes().n() > 1 ? fmt::format("{} processes of ", processes().n()) : "", loop->n_workers(),
      loop->n_workers() == 1 ? "" : "s", duration_in_words(duration));
  if (case_.map) print_map(case_, case_file);
  return 0;
}

}  // namespace talus
