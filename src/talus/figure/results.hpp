#pragma once
/// Results of a figure's curves: element tests, and runs of cases read back from their folders.

#include <filesystem>
#include <functional>
#include <string>
#include <vector>

#include "talus/figure/evaluation.hpp"
#include "talus/mpm/backend.hpp"

namespace talus {

/// A figure with the results of its curves and its evaluation.
struct RemadeFigure {
  FigureSpec spec;
  FigureRuns runs;
  FigureResult result;
};

/// Reads the figures in these folders. Throws InputError with every mistake in all of them at once.
std::vector<RemadeFigure> read_figures(const std::vector<std::filesystem::path>& folders);

/// One curve of one reading.
struct CurveOfReading {
  RemadeFigure* figure;
  std::size_t reading, curve;
};
/// Curves whose results are element tests, or runs of cases: figure by figure, reading by reading.
std::vector<CurveOfReading> curves_of_tests(std::vector<RemadeFigure>& figures);
std::vector<CurveOfReading> curves_of_cases(std::vector<RemadeFigure>& figures);

/// Runs the element tests of these curves side by side.
void run_element_tests(const std::vector<CurveOfReading>& curves, Backend& loop);

/// Runs a case and writes its results into a folder. Returns the reason if the run failed, else an empty text.
using RunCase = std::function<std::string(const std::filesystem::path& folder, const std::string& case_text)>;

/// Runs the cases of a curve, with the results in `figures_folder`, and reads the curve from them: the history or the
/// surface of a single run, or a row for each run of a sweep: its end and its values in the sweep's columns.
void run_cases(const CurveOfReading& curve, const std::filesystem::path& figures_folder, const RunCase& run);

/// Reads history.csv, surface.csv or rings.csv of a run; units become those of the columns.
ResultTable read_results(const std::filesystem::path& file);

/// Reads the profile of the surface at one instant from surface.csv, or rings.csv of a run in 3D: of all instants in it the nearest to `time` [s].
ResultTable read_surface(const std::filesystem::path& file, double time);

}  // namespace talus
