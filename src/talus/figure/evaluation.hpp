#pragma once
/// Evaluation of a figure whose element tests and cases have run: curves in the axes of the panels, tables, and verdicts
/// on the claims.

#include <map>

#include "talus/base/table.hpp"
#include "talus/figure/specification.hpp"

namespace talus {

/// Results of the curves, [reading][curve]; empty where a reading has no such curve.
using FigureRuns = std::vector<std::vector<std::optional<ResultTable>>>;

struct PlottedPoints {
  std::vector<double> x, y;
};

/// One curve in one panel and reading.
struct DrawnCurve {
  int curve;
  PlottedPoints computed, measured;
  double misfit;           ///< rms distance in y from the measured points over the largest of these; NaN without them
  double deviation;        ///< largest distance in y from the measured points, in units of the axis; NaN without them
  double relative_misfit;  ///< rms of the distances in y from the points in its reach, each over its point; NaN without
};

/// A row of a table: one of a curve's runs.
struct NumbersRow {
  int curve;
  std::vector<double> numbers;
};

/// Verdict on a statement: a number for every reading (NaN where it has none), and the readings in which it holds.
struct Verdict {
  std::vector<double> numbers;
  std::vector<bool> holds;

  bool in_first() const { return holds.at(0); }
  bool in_another() const;
};

struct FigureResult {
  std::vector<std::vector<std::vector<DrawnCurve>>> panels;  ///< [reading][panel][curve of the panel]
  std::vector<std::vector<std::vector<NumbersRow>>> tables;  ///< [reading][table][row]
  std::vector<Verdict> verdicts;                             ///< one for every statement
};

/// Draws the panels' points and decides the statements. Throws InputError where a formula is wrong.
FigureResult evaluate_figure(const FigureSpec& figure, const FigureRuns& runs);

}  // namespace talus
