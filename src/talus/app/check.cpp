#include <fmt/format.h>

#include <chrono>
#include <cmath>

#include "talus/app/commands.hpp"
#include "talus/app/progress.hpp"
#include "talus/app/task.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/machine.hpp"
#include "talus/case/read.hpp"
#include "talus/mpm/simulation.hpp"
#include "talus/output/report.hpp"

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
  const auto simulation = make_simulation(what, *loop);
  const double first = simulation->next_dt();
  const double n = double(simulation->n_particles());
  const double cells = double(what.n_cells[0]) * what.n_cells[1] * (what.dim == 3 ? what.n_cells[2] : 1);
  fmt::print(
      "\n  particles           {}\n  cells               {:.0f}, {} of them near particles\n  first stable step   "
      "{:.3g} s\n",
      simulation->n_particles(), cells, simulation->n_tiles() * (what.dim == 3 ? 64 : 16), first);
  if (what.numerics.dt && *what.numerics.dt > 0) fmt::print("  fixed step          {:.3g} s\n", *what.numerics.dt);
  // How fast this machine is shows only when it does the work: steps of this very case, for a second.
  const auto start = std::chrono::steady_clock::now();
  const auto seconds = [&] { return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(); };
  long steps = 0;
  while (seconds() < 1 && simulation->ledger().time < what.end) {
    simulation->step();
    ++steps;
  }
  const double per_step = seconds() / double(std::max(1L, steps));
  const double expected = what.end / first;
  fmt::print(
      "  expected steps      {:.3g}\n  memory              {:.3g} MB\n  speed here          {:.3g} M particle-steps/s "
      "on {} thread{}\n  expected duration   {}\n",
      expected, 1e-6 * double(simulation->bytes()), 1e-6 * n / per_step, loop->n_workers(),
      loop->n_workers() == 1 ? "" : "s", duration_in_words(expected * per_step));
  return 0;
}

}  // namespace talus
