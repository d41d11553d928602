#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>
#include <filesystem>

#include "talus/app/commands.hpp"
#include "talus/app/interrupt.hpp"
#include "talus/app/progress.hpp"
#include "talus/app/threads.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/error.hpp"
#include "talus/base/file.hpp"
#include "talus/calibration/read_calibration.hpp"
#include "talus/calibration/report.hpp"
#include "talus/case/material.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

fs::path folder_of(const CalibrateOptions& options) {
  return options.out.empty() ? fs::path("out") / fs::path(options.data_file).stem() : fs::path(options.out);
}

/// Throws InputError if the folder holds results and --overwrite is not given.
void expect_room(const fs::path& folder, const CalibrateOptions& options) {
  if (options.overwrite || options.resume) return;
  if (fs::exists(folder / "state.json"))
    throw InputError(
        fmt::format("{} holds a calibration already; resume it with --resume, start again with --overwrite, or use "
                    "another folder with --out",
                    folder.string()));
  if (fs::exists(folder / "index.html") || fs::exists(folder / "case.toml"))
    throw InputError(fmt::format("{} holds other results; give another folder with --out", folder.string()));
}

void print_plan(const Calibration& c, int threads) {
  long rows = 0;
  for (const MeasuredTest& test : c.tests) rows += long(test.n_rows());
  const Price price = price_of(c);
  fmt::print(stderr, "{}: law {}, {} free parameters, {} tests, {} measured rows; {} thread{}\n", c.title,
             name_of(c.law), c.free.size(), c.tests.size(), rows, threads, threads == 1 ? "" : "s");
  fmt::print(stderr, "about {} computations of all tests: {} to search from {} start{}, {} to leave out each test\n",
             price.of_searches + price.of_leave_one_out, price.of_searches, c.settings.starts,
             c.settings.starts == 1 ? "" : "s", price.of_leave_one_out);
}

}  // namespace

int calibrate_law(const CalibrateOptions& options) {
  const Calibration calibration = read_calibration(options.data_file);
  const fs::path folder = folder_of(options);
  expect_room(folder, options);
  std::error_code failure;
  fs::create_directories(folder, failure);
  if (!fs::is_directory(folder)) throw InputError(fmt::format("the folder {} cannot be made", folder.string()));
  const FolderLock lock(folder);
  const fs::path state_file = folder / "state.json";
  CalibrationState state;
  if (options.resume && fs::exists(state_file)) state = read_state(state_file, calibration.fingerprint);
  const auto loop = make_threads(usable_threads(options.threads, options.force_threads));
  print_plan(calibration, loop->n_workers());

  const Interrupt interrupt;
  const bool live = isatty(STDERR_FILENO);
  CalibrationObserver observer;
  observer.progress = [&](const std::string& where, double misfit, long evaluations, double left) {
    fmt::print(stderr, "{}{}: misfit {:.5f}, {} computations, {} left{}", live ? "\r\033[K" : "", where, misfit,
               evaluations, duration_in_words(left), live ? "" : "\n");
    std::fflush(stderr);
  };
  observer.save = [&](const CalibrationState& s) { write_state(state_file, s); };
  observer.stop = [&] { return interrupt.signal() != 0; };
  const std::optional<CalibrationResult> result = calibrate(calibration, *loop, state, observer);
  if (live) fmt::print(stderr, "\r\033[K");
  if (!result) {
    fmt::print(stderr, "stopped; to resume: talus calibrate {} --out {} --resume\n", options.data_file,
               folder.string());
    return exit_signal + interrupt.signal();
  }
  const bool drawn = write_report(folder, calibration, *result);
  fmt::print("{}", result_in_words(calibration, *result));
  fmt::print("\n{} computations of all tests in {:.1f} s\n", result->evaluations, result->seconds);
  if (!drawn) fmt::print(stderr, "warning: no pictures were drawn; gnuplot is not installed\n");
  fmt::print("material: {}\npage:     {}\n", (folder / "material.toml").string(),
             fs::absolute(folder / "index.html").string());
  return 0;
}

}  // namespace talus
