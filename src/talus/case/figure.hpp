#pragma once
/// A figure to be remade: curves, panels, and what a text claims about it. validation/README.md has the format.

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
  std::string text;  ///< the test file with everything set, to be run again by itself
  ElementTest test;
};

/// The runs of a curve in one reading: one whose history is the curve, or a sweep of which each run's end is a row.
struct CurveRuns {
  struct Run {
    std::string text;            ///< the case file with everything set, to be run again by itself
    std::vector<double> values;  ///< in the sweep's columns
  };
  std::vector<std::string> columns;  ///< that the sweep adds to those of the history
  std::vector<Run> runs;
  bool is_sweep = false;
};

struct CurveSpec {
  std::string name, label;
  std::vector<std::optional<CurveTest>> tests;  ///< one for every reading, if the curve is an element test
  std::vector<std::optional<CurveRuns>> runs;   ///< one for every reading, if it is runs of cases
  std::optional<NumberTable> measured;
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

/// A claim, the number that decides it, and the range in which it holds; without a number it cannot be checked.
struct Statement {
  std::string text, where, number, meaning, why;
  std::optional<double> at_least, at_most;

  bool allows(double x) const { return (!at_least || x >= *at_least) && (!at_most || x <= *at_most) && x == x; }
};

struct FigureSpec {
  std::string name;  ///< of its folder
  std::string title, source, note, abscissa;
  std::vector<Reading> readings;
  std::vector<CurveSpec> curves;
  std::vector<Panel> panels;
  std::vector<Statement> statements;
};

/// Reads FOLDER/figure.toml, and the tests and cases it names. Throws InputError with every mistake at once.
FigureSpec read_figure(const std::string& folder);

}  // namespace talus
