#pragma once
/// A figure to be remade, as plain data: curves, panels, and the claims of a text about it.

#include <algorithm>
#include <optional>
#include <string>
#include <vector>

#include "talus/base/table.hpp"
#include "talus/case/loading.hpp"

namespace talus {

/// One way to read the source; the whole figure is computed once for each.
struct Reading {
  std::string name, meaning;
};

/// The element test of a curve in one reading.
struct CurveTest {
  std::string text;  ///< the test file with all keys replaced, which can be run again by itself
  ElementTest test;
};

/// The runs of a curve in one reading: one whose history or surface is the curve, or a sweep of which each run's end is
/// a row.
struct CurveRuns {
  struct Run {
    std::string text;            ///< the case file with all keys replaced, which can be run again by itself
    std::vector<double> values;  ///< in the sweep's columns
  };
  std::vector<std::string> columns;  ///< that the sweep adds to those of the history
  std::vector<Run> runs;
  bool is_sweep = false;
};

struct CurveSpec {
  std::string name, label;
  std::string abscissa;                         ///< column along which numbers of the curve are measured
  std::optional<double> surface_at;             ///< the curve is the surface of the material at that instant [s]
  std::vector<std::optional<CurveTest>> tests;  ///< one for every reading, if the curve is an element test
  std::vector<std::optional<CurveRuns>> runs;   ///< one for every reading, if it is runs of cases
  std::optional<NumberTable> measured;
  std::string measured_label;

  /// Whether there is nothing to compute.
  bool is_measurement() const { return tests.empty() && runs.empty(); }
  /// Whether each row is the end of a run.
  bool is_sweep() const {
    return std::any_of(runs.begin(), runs.end(), [](const auto& r) { return r && r->is_sweep; });
  }
};

/// One axis of a panel: formulas of the columns of a curve and of the measurements.
struct Axis {
  std::string value, label, measured;
  bool log = false;
  std::optional<double> min, max;
};

struct Panel {
  std::string name, title;
  Axis x, y;
  std::vector<int> curves;
};

/// A table of numbers: a row for the last instant of each curve, or for each run of a sweep.
struct NumbersSpec {
  struct Column {
    std::string label, value;  ///< formula of the columns of a curve
    int digits;                ///< behind the point
  };
  std::string title, note;
  std::vector<int> curves;
  std::vector<Column> columns;
};

/// A picture that a run has made of its particles.
struct PictureSpec {
  int curve;  ///< whose run it is; the first of a sweep
  std::string quantity, title;
};

/// A claim, the number that decides it, and the range in which it holds; without a number it cannot be checked.
struct Statement {
  std::string text, where, number, meaning, why;
  std::optional<double> at_least, at_most;

  bool allows(double x) const { return (!at_least || x >= *at_least) && (!at_most || x <= *at_most) && x == x; }
};

struct FigureSpec {
  std::string name;  ///< of its folder
  std::string title, source, note;
  std::vector<Reading> readings;
  std::vector<CurveSpec> curves;
  std::vector<Panel> panels;
  std::vector<NumbersSpec> tables;
  std::vector<PictureSpec> pictures;
  std::vector<Statement> statements;
};

}  // namespace talus
