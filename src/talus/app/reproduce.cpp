#include <fmt/format.h>

#include <chrono>
#include <filesystem>
#include <fstream>

#include "talus/app/commands.hpp"
#include "talus/app/threads.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/error.hpp"
#include "talus/figure/folders.hpp"
#include "talus/figure/index.hpp"
#include "talus/figure/page.hpp"
#include "talus/figure/verdict.hpp"
#include "talus/output/record.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

/// The user has stopped a run, which prints how to resume it: reproduce ends with its exit code.
struct Stopped {
  int exit_code;
};

void run_or_stop(const RunOptions& options) {
  if (const int code = run_case(options); code != 0) throw Stopped{code};
}

/// Runs a case in a folder. Results of the same case that are there are kept if they are complete, else resumed; those of
/// another case are overwritten. Returns the reason if the run failed.
std::string run_in(const fs::path& folder, const std::string& case_text, int threads) {
  if (is_finished(folder, case_text)) return "";
  fs::create_directories(folder.parent_path());
  const fs::path file = folder.string() + ".toml";
  std::ofstream(file) << case_text;
  RunOptions options;
  options.case_file = file.string();
  options.out = folder.string();
  options.threads = threads;
  options.resume = fs::exists(folder / "history.csv");
  try {
    try {
      run_or_stop(options);
    } catch (const InputError&) {  // of another case
      if (!options.resume) throw;
      options.resume = false;
      options.overwrite = true;
      run_or_stop(options);
    }
  } catch (const RunError& e) {
    return e.what();
  }
  return "";
}

void run_all_element_tests(std::vector<RemadeFigure>& figures, int threads) {
  const std::vector<CurveOfReading> curves = curves_of_tests(figures);
  const auto loop = make_threads(threads);
  fmt::print(stderr, "{} element tests in {} figure{} on {} thread{}\n", curves.size(), figures.size(),
             figures.size() == 1 ? "" : "s", loop->n_workers(), loop->n_workers() == 1 ? "" : "s");
  const auto start = std::chrono::steady_clock::now();
  run_element_tests(curves, *loop);
  const std::chrono::duration<double> elapsed = std::chrono::steady_clock::now() - start;
  fmt::print(stderr, "done in {:.1f} s\n", elapsed.count());
}

void print_verdicts(const RemadeFigure& figure) {
  const auto [hold, elsewhere, fail, unchecked] = count_findings(figure);
  fmt::print("{:<24} {:>3} of {} claims hold{}\n", figure.spec.name, hold, figure.result.verdicts.size(),
             (elsewhere > 0 ? fmt::format(", {} more in another reading", elsewhere) : "") +
                 (unchecked > 0 ? fmt::format(", {} cannot be checked", unchecked) : ""));
}

}  // namespace

int reproduce(const ReproduceOptions& options) {
  std::vector<RemadeFigure> figures = read_figures(figure_folders(options.from, options.figure));
  const fs::path out = options.out.empty() ? fs::path("out") / "reproduce" : fs::path(options.out);
  const int threads = usable_threads(options.threads, options.force_threads);
  run_all_element_tests(figures, threads);
  const auto run = [&](const fs::path& folder, const std::string& text) { return run_in(folder, text, threads); };
  try {
    for (const CurveOfReading& curve : curves_of_cases(figures)) run_cases(curve, out, run);
  } catch (const Stopped& stopped) {
    return stopped.exit_code;
  }
  bool drawn = true;
  for (RemadeFigure& figure : figures) {
    figure.result = evaluate_figure(figure.spec, figure.runs);
    drawn = write_figure(out / figure.spec.name, figure) && drawn;
    print_verdicts(figure);
  }
  if (!drawn) fmt::print(stderr, "warning: no pictures were drawn; gnuplot is not installed\n");
  write_figure_index(out / "index.html", figures);
  fmt::print("index:  {}\n", fs::absolute(out / "index.html").string());
  return 0;
}

}  // namespace talus
