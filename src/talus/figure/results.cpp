#include "talus/figure/results.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "talus/base/error.hpp"
#include "talus/element/driver.hpp"
#include "talus/figure/folders.hpp"
#include "talus/figure/read_figure.hpp"
#include "talus/output/history.hpp"
#include "talus/output/record.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

/// Every curve of every reading for which `chosen` is true.
template <class Chosen>
std::vector<CurveOfReading> curves_that(std::vector<RemadeFigure>& figures, Chosen chosen) {
  std::vector<CurveOfReading> curves;
  for (RemadeFigure& f : figures)
    for (std::size_t r = 0; r < f.spec.readings.size(); ++r)
      for (std::size_t c = 0; c < f.spec.curves.size(); ++c)
        if (chosen(f.spec.curves[c], r)) curves.push_back({&f, r, c});
  return curves;
}

/// The columns of a run's history, and those that the sweep adds.
ResultTable empty_sweep(const ResultTable& history, const std::vector<std::string>& added) {
  ResultTable table = history;
  table.rows.clear();
  for (const std::string& column : added) {
    table.names.push_back(column);
    table.units.emplace_back("1");
    table.meanings.emplace_back();
  }
  return table;
}

/// Adds the numbers of a run's record, the same in every row, except those that a sweep has under the same name.
void add_numbers_of_record(const fs::path& folder, const std::vector<std::string>& of_sweep, ResultTable& results) {
  for (const auto& [name, number] : numbers_of_record(folder)) {
    if (std::ranges::find(of_sweep, name) != of_sweep.end()) continue;
    results.names.push_back(name);
    results.units.emplace_back("1");
    results.meanings.emplace_back();
    for (auto& row : results.rows) row.push_back(number);
  }
}

}  // namespace

std::vector<RemadeFigure> read_figures(const std::vector<fs::path>& folders) {
  std::vector<RemadeFigure> figures;
  std::vector<Complaint> complaints;
  for (const fs::path& folder : folders) {
    try {
      RemadeFigure& f = figures.emplace_back(RemadeFigure{read_figure(folder.string()), {}, {}});
      f.runs.assign(f.spec.readings.size(), std::vector<std::optional<ResultTable>>(f.spec.curves.size()));
    } catch (const InputError& e) {
      complaints.insert(complaints.end(), e.complaints().begin(), e.complaints().end());
    }
  }
  if (!complaints.empty()) throw InputError(complaints);
  return figures;
}

std::vector<CurveOfReading> curves_of_tests(std::vector<RemadeFigure>& figures) {
  return curves_that(figures,
                     [](const CurveSpec& c, std::size_t reading) { return !c.tests.empty() && c.tests[reading]; });
}

std::vector<CurveOfReading> curves_of_cases(std::vector<RemadeFigure>& figures) {
  return curves_that(figures,
                     [](const CurveSpec& c, std::size_t reading) { return !c.runs.empty() && c.runs[reading]; });
}

void run_element_tests(const std::vector<CurveOfReading>& curves, Backend& loop) {
  loop.for_each(int(curves.size()), [&](int i, int) {
    const auto& [figure, reading, curve] = curves[i];
    figure->runs[reading][curve] = run_element_test(figure->spec.curves[curve].tests[reading]->test);
  });
}

void run_cases(const CurveOfReading& which, const fs::path& figures_folder, const RunCase& run) {
  const auto& [figure, reading, number] = which;
  const CurveSpec& curve = figure->spec.curves[number];
  const CurveRuns& runs = *curve.runs[reading];
  ResultTable sweep;
  for (std::size_t k = 0; k < runs.runs.size(); ++k) {
    const fs::path folder = figures_folder / figure->spec.name / run_folder(figure->spec, reading, curve, k);
    const std::string failure = run(folder, runs.runs[k].text);
    ResultTable one =
        curve.surface_at ? read_surface(profile_file(folder), *curve.surface_at) : read_results(folder / "history.csv");
    if (!curve.surface_at) add_numbers_of_record(folder, runs.columns, one);
    one.failure = failure;
    if (!runs.is_sweep) {
      figure->runs[reading][number] = std::move(one);
      return;
    }
    if (k == 0) sweep = empty_sweep(one, runs.columns);
    sweep.rows.push_back(one.rows.back());
    sweep.rows.back().insert(sweep.rows.back().end(), runs.runs[k].values.begin(), runs.runs[k].values.end());
    if (!failure.empty()) sweep.failure += fmt::format("run {}: {} ", k + 1, failure);
  }
  figure->runs[reading][number] = std::move(sweep);
}

ResultTable read_results(const fs::path& file) {
  ResultTable table{read_csv(file.string()), {}, {}, ""};
  for (std::string& name : table.names) {
    const auto unit = name.find(" [");
    table.units.push_back(unit == std::string::npos ? "1" : name.substr(unit + 2, name.size() - unit - 3));
    name.resize(std::min(unit, name.size()));
  }
  table.meanings.resize(table.names.size());
  return table;
}

ResultTable read_surface(const fs::path& file, double time) {
  ResultTable table = read_results(file);
  double nearest = std::numeric_limits<double>::infinity();
  for (const auto& row : table.rows)
    if (std::abs(row[0] - time) < std::abs(nearest - time)) nearest = row[0];
  std::erase_if(table.rows, [&](const auto& row) { return row[0] != nearest; });
  return table;
}

}  // namespace talus
