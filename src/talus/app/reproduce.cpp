#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>

#include "talus/app/commands.hpp"
#include "talus/backend/backend.hpp"
#include "talus/base/error.hpp"
#include "talus/base/text.hpp"
#include "talus/element/driver.hpp"
#include "talus/figure/page.hpp"
#include "talus/output/record.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

/// The figures asked for, in the order of their names.
std::vector<fs::path> folders_of(const ReproduceOptions &options) {
  std::vector<fs::path> folders;
  std::error_code failure;
  for (const auto &entry : fs::directory_iterator(options.from, failure))
    if (fs::exists(entry.path() / "figure.toml"))
      folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  if (folders.empty())
    throw InputError(fmt::format(
        "{} holds no folders with a figure.toml; name the folder with --from",
        options.from));
  if (options.figure == "all")
    return folders;
  std::vector<std::string> names;
  for (const fs::path &f : folders) {
    names.push_back(f.filename().string());
    if (names.back() == options.figure ||
        names.back() == fmt::format("figure_{:0>2}", options.figure))
      return {f};
  }
  const std::vector<std::string_view> words(names.begin(), names.end());
  const std::string_view alike = most_alike(options.figure, words);
  throw InputError(fmt::format("`{}` is no figure; {}", options.figure,
                               alike.empty()
                                   ? "there is all, " + any_of(words)
                                   : fmt::format("did you mean `{}`?", alike)));
}

/// history.csv or surface.csv of a run.
ResultTable table_of(const fs::path &file) {
  ResultTable table{read_csv(file.string()), {}, {}, ""};
  for (std::string &name : table.names) {
    const auto unit = name.find(" [");
    table.units.push_back(unit == std::string::npos
                              ? "1"
                              : name.substr(unit + 2, name.size() - unit - 3));
    name.resize(std::min(unit, name.size()));
  }
  table.meanings.resize(table.names.size());
  return table;
}

/// The surface of a run's material at an instant: of all that it has written,
/// the nearest.
ResultTable surface_of(const fs::path &folder, double time) {
  ResultTable table = table_of(folder / "surface.csv");
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto &row : table.rows)
    if (std::abs(row[0] - time) < std::abs(nearest - time))
      nearest = row[0];
  std::erase_if(table.rows, [&](const auto &row) { return row[0] != nearest; });
  return table;
}

/// The user has stopped a run, which says how it goes on: reproduce ends with
/// its exit code.
struct Stopped {
  int exit_code;
};

/// Runs a case in its folder, and tells why it broke if it did. What stands
/// there already of the same case is gone on with, or kept if it is complete.
std::string run_in(const fs::path &folder, const std::string &case_text,
                   int threads) {
  if (is_finished(folder, case_text))
    return "";
  fs::create_directories(folder.parent_path());
  const fs::path file = folder.string() + ".toml";
  std::ofstream(file) << case_text;
  RunOptions options;
  options.case_file = file.string();
  options.out = folder.string();
  options.threads = threads;
  std::string failure;
  const auto run = [&] {
    if (const int code = run_case(options); code != 0)
      throw Stopped{code};
  };
  try {
    options.resume = fs::exists(folder / "history.csv");
    try {
      run();
    } catch (const InputError &) { // of another case
      if (!options.resume)
        throw;
      options.resume = false;
      options.overwrite = true;
      run();
    }
  } catch (const RunError &e) {
    failure = e.what();
  }
  return failure;
}

/// A curve made of runs: the history or surface of a single one, or a row of
/// numbers and of the end of each run of a sweep.
ResultTable run_cases(const RemadeFigure &figure, std::size_t reading,
                      std::size_t curve, const fs::path &out, int threads) {
  const CurveSpec &spec = figure.spec.curves[curve];
  const CurveRuns &runs = *spec.runs[reading];
  ResultTable table;
  for (std::size_t k = 0; k < runs.runs.size(); ++k) {
    const fs::path folder =
        out / figure.spec.name / run_folder(figure.spec, reading, spec, k);
    const std::string failure = run_in(folder, runs.runs[k].text, threads);
    ResultTable one = spec.surface_at ? surface_of(folder, *spec.surface_at)
                                      : table_of(folder / "history.csv");
    one.failure = failure;
    if (!runs.is_sweep)
      return one;
    if (k == 0) {
      table = one;
      table.rows.clear();
      for (const std::string &column : runs.columns) {
        table.names.push_back(column);
        table.units.emplace_back("1");
        table.meanings.emplace_back();
      }
    }
    table.rows.push_back(one.rows.back());
    table.rows.back().insert(table.rows.back().end(),
                             runs.runs[k].values.begin(),
                             runs.runs[k].values.end());
    if (!one.failure.empty())
      table.failure += fmt::format("run {}: {} ", k + 1, one.failure);
  }
  return table;
}

} // namespace

int reproduce(const ReproduceOptions &options) {
  std::vector<RemadeFigure> figures;
  std::vector<Complaint> complaints;
  for (const fs::path &folder : folders_of(options)) {
    try {
      figures.push_back({read_figure(folder.string()), {}, {}});
    } catch (const InputError &e) {
      complaints.insert(complaints.end(), e.complaints().begin(),
                        e.complaints().end());
    }
  }
  if (!complaints.empty())
    throw InputError(complaints);

  struct Run {
    RemadeFigure *figure;
    std::size_t reading, curve;
  };
  std::vector<Run> runs;
  for (RemadeFigure &f : figures) {
    f.runs.assign(
        f.spec.readings.size(),
        std::vector<std::optional<ResultTable>>(f.spec.curves.size()));
    for (std::size_t r = 0; r < f.spec.readings.size(); ++r)
      for (std::size_t c = 0; c < f.spec.curves.size(); ++c) {
        const CurveSpec &curve = f.spec.curves[c];
        if (!curve.tests.empty() && curve.tests[r])
          runs.push_back({&f, r, c});
      }
  }
  const fs::path out = options.out.empty() ? fs::path("out") / "reproduce"
                                           : fs::path(options.out);
  const auto loop = make_openmp(options.threads);
  fmt::print(stderr, "{} element tests in {} figure{} on {} thread{}\n",
             runs.size(), figures.size(), figures.size() == 1 ? "" : "s",
             loop->n_workers(), loop->n_workers() == 1 ? "" : "s");
  const auto start = std::chrono::steady_clock::now();
  loop->for_each(int(runs.size()), [&](int i, int) {
    const Run &run = runs[i];
    run.figure->runs[run.reading][run.curve] = run_element_test(
        run.figure->spec.curves[run.curve].tests[run.reading]->test);
  });
  const std::chrono::duration<double> taken =
      std::chrono::steady_clock::now() - start;
  fmt::print(stderr, "done in {:.1f} s\n", taken.count());

  for (RemadeFigure &f : figures)
    for (std::size_t r = 0; r < f.spec.readings.size(); ++r)
      for (std::size_t c = 0; c < f.spec.curves.size(); ++c) {
        const CurveSpec &curve = f.spec.curves[c];
        if (curve.runs.empty() || !curve.runs[r])
          continue;
        try {
          f.runs[r][c] = run_cases(f, r, c, out, options.threads);
        } catch (const Stopped &stopped) {
          return stopped.exit_code;
        }
      }
  bool drawn = true;
  for (RemadeFigure &f : figures) {
    f.result = evaluate_figure(f.spec, f.runs);
    drawn = write_figure(out / f.spec.name, f) && drawn;
    int hold = 0, elsewhere = 0, unchecked = 0;
    for (const Statement &s : f.spec.statements)
      unchecked += s.number.empty();
    for (const Verdict &v : f.result.verdicts) {
      hold += v.in_first();
      elsewhere += !v.in_first() && v.in_another();
    }
    fmt::print(
        "{:<24} {:>3} of {} claims hold{}\n", f.spec.name, hold,
        f.result.verdicts.size(),
        (elsewhere > 0 ? fmt::format(", {} more in another reading", elsewhere)
                       : "") +
            (unchecked > 0 ? fmt::format(", {} cannot be checked", unchecked)
                           : ""));
  }
  if (!drawn)
    fmt::print(stderr,
               "warning: no pictures were drawn; gnuplot is not installed\n");
  write_figure_index(out / "index.html", figures);
  fmt::print("index:  {}\n", fs::absolute(out / "index.html").string());
  return 0;
}

} // namespace talus
