#include <fmt/format.h>
#include <unistd.h>

#include <chrono>
#include <cmath>
#include <filesystem>

#include "talus/app/commands.hpp"
#include "talus/app/progress.hpp"
#include "talus/app/rehearsal.hpp"
#include "talus/app/task.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/machine.hpp"
#include "talus/input/read.hpp"
#include "talus/mpm/simulation.hpp"
#include "talus/output/plot.hpp"
#include "talus/output/report.hpp"
#include "talus/output/snapshot.hpp"

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

/// What something takes that is done again and again for a while, so that one hiccup of the machine does not count [s].
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

/// What writing takes [s].
struct OutputTimes {
  double row, snapshot, end;
};

/// Writes rows, snapshots and pictures of a run's start into a folder that is removed again.
OutputTimes try_output(const Case& what, Simulation& simulation) {
  namespace fs = std::filesystem;
  const fs::path folder = fs::temp_directory_path() / fmt::format("talus_check_{}", ::getpid());
  fs::create_directories(folder);
  OutputTimes times{};
  const OutlineFinder outlines(what, simulation.places());
  History history(folder / "history.csv", what);
  times.row = mean_time([&] { history.add(simulation.ledger(), outlines.find(simulation.places())); });
  Observation seen;
  times.snapshot = mean_time([&] {
    seen = simulation.observe();
    write_snapshot(folder / "particles.hdf", seen, *what.output.fields);
  });
  history.add(simulation.ledger(), outlines.find(simulation.places()));  // a curve has two points at least
  PictureBook pictures(folder / "pictures", what);
  const auto draw_one_more = [&] {
    pictures.add(seen);
    const Clock clock;
    pictures.draw();
    return clock.seconds();
  };
  if (const std::size_t n = what.output.pictures->size(); n > 0) {  // the first instant brings gnuplot's start with it
    const double one = draw_one_more(), two = draw_one_more();
    times.end = one + std::max(0.0, two - one) * double(n - 1);
  }
  const Clock of_charts;
  for (const Chart& chart : charts_of(history, length_unit_for(extent(what))))
    if (!draw_chart(folder / "pictures", folder / "history.csv", chart)) break;
  times.end += of_charts.seconds();
  fs::remove_all(folder);
  return times;
}

}  // namespace

int check_case(const std::string& case_file, int threads) {
  const CaseFile input = read_case(case_file);
  const Case& what = input.what;
  fmt::print("{} is understood as\n", case_file);
  print_understood(input.understood);

  for (const std::string& notice : {notice_of_stiffness(what.numerics), notice_of_preset(what)})
    if (!notice.empty()) fmt::print("\nwarning: {}\n", notice);

  if (const std::string notice = notice_of_symmetry(what); !notice.empty()) fmt::print("\n  {}\n", notice);

  expect_memory_for(what);
  const auto loop = make_openmp(threads);
  auto simulation = make_simulation(what, *loop);
  const double first = simulation->next_dt();
  const double n = double(simulation->n_particles());
  const double cells = double(what.n_cells[0]) * what.n_cells[1] * (what.dim == 3 ? what.n_cells[2] : 1);
  fmt::print(
      "\n  particles           {}\n  cells               {:.0f}, {} of them near particles\n  first stable step   "
      "{:.3g} s\n",
      simulation->n_particles(), cells, simulation->n_tiles() * (what.dim == 3 ? 64 : 16), first);
  if (what.numerics.dt && *what.numerics.dt > 0) fmt::print("  fixed step          {:.3g} s\n", *what.numerics.dt);
  // How fast this machine is shows only when it does the work: steps of this very case, for a second.
  const Clock clock;
  while (clock.seconds() < 1 && simulation->ledger().time < what.end) simulation->step();
  const long tried = simulation->ledger().step;
  const double per_step = clock.seconds() / double(std::max(1L, tried));
  const std::size_t bytes = simulation->bytes();
  const OutputTimes output = try_output(what, *simulation);
  double steps = double(tried);
  std::string how = fmt::format("{}, found by running it to its end", tried);
  if (simulation->ledger().time < what.end) {
    simulation.reset();  // makes room for another one
    if (what.numerics.dt) {
      steps = what.end / *what.numerics.dt;
      how = fmt::format("{:.0f}, as the case fixes their length", steps);
    } else {
      const Rehearsal rehearsal = rehearse(what, *loop, what.end / first * per_step, 1);
      steps = rehearsal.steps;
      how = fmt::format("about {:.3g}, by a run on cells {} until {:.3g} s", steps,
                        rehearsal.coarser == 1 ? "of this size" : fmt::format("{} times coarser", rehearsal.coarser),
                        rehearsal.until);
    }
  }
  const auto instants = [&](double interval) { return std::min(steps, what.end / interval) + 1; };
  const double expected = steps * per_step + instants(*what.output.history) * output.row +
                          instants(*what.output.snapshots) * output.snapshot + output.end;
  fmt::print(
      "  expected steps      {}\n  memory              {:.3g} MB\n  speed here          {:.3g} M "
      "particle-steps/s on {} thread{}\n  expected duration   {}\n",
      how, 1e-6 * double(bytes), 1e-6 * n / per_step, loop->n_workers(), loop->n_workers() == 1 ? "" : "s",
      duration_in_words(expected));
  return 0;
}

}  // namespace talus
