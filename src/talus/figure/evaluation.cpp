#include "talus/figure/evaluation.hpp"

#include <fmt/format.h>
#include <muParser.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>

#include "talus/base/error.hpp"

namespace talus {

namespace {

constexpr double none = std::numeric_limits<double>::quiet_NaN();

/// y at x of a line through points with growing or falling x; none outside.
double interpolate(const PlottedPoints& line, double x) {
  for (std::size_t i = 1; i < line.x.size(); ++i) {
    const double a = line.x[i - 1], b = line.x[i];
    if ((a <= x && x <= b) || (b <= x && x <= a))
      return a == b ? line.y[i] : line.y[i - 1] + (x - a) / (b - a) * (line.y[i] - line.y[i - 1]);
  }
  return none;
}

/// Distance in y of a line from each point. Beyond the line, the distance is that from its end.
std::vector<double> distances(const PlottedPoints& line, const PlottedPoints& points) {
  std::vector<double> all;
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    if (!std::isfinite(points.x[i]) || !std::isfinite(points.y[i]) || line.y.empty()) continue;
    double y = interpolate(line, points.x[i]);
    if (!std::isfinite(y)) {
      const bool nearer_end = std::abs(points.x[i] - line.x.back()) <= std::abs(points.x[i] - line.x.front());
      y = nearer_end ? line.y.back() : line.y.front();
    }
    all.push_back(std::abs(y - points.y[i]));
  }
  return all;
}

/// rms distance of a line from points, over the largest point.
double misfit_of(const std::vector<double>& distances, const PlottedPoints& points) {
  double sum = 0, largest = 0;
  for (double d : distances) sum += d * d;
  for (double y : points.y)
    if (std::isfinite(y)) largest = std::max(largest, std::abs(y));
  return !distances.empty() && largest > 0 ? std::sqrt(sum / double(distances.size())) / largest : none;
}

/// rms of the relative distances of a line from the points within its reach.
double relative_misfit_of(const PlottedPoints& line, const PlottedPoints& points) {
  double sum = 0;
  int n = 0;
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    const double off = interpolate(line, points.x[i]) / points.y[i] - 1;
    if (!std::isfinite(off)) continue;
    sum += off * off;
    ++n;
  }
  return n > 0 ? std::sqrt(sum / n) : none;
}

DrawnCurve draw(const Panel& panel, const CurveSpec& spec, int curve, const std::optional<ResultTable>& result) {
  DrawnCurve drawn{curve, {}, {}, none, none, none};
  if (result) drawn.computed = {evaluate(panel.x.value, *result), evaluate(panel.y.value, *result)};
  if (spec.measured && !panel.x.measured.empty() && !panel.y.measured.empty()) {
    drawn.measured = {evaluate(panel.x.measured, *spec.measured), evaluate(panel.y.measured, *spec.measured)};
    const std::vector<double> off = distances(drawn.computed, drawn.measured);
    drawn.misfit = misfit_of(off, drawn.measured);
    drawn.relative_misfit = relative_misfit_of(drawn.computed, drawn.measured);
    if (!off.empty()) drawn.deviation = *std::max_element(off.begin(), off.end());
  }
  return drawn;
}

/// A row a curve, or a row for every run of a sweep.
std::vector<NumbersRow> rows_of(const FigureSpec& figure, const NumbersSpec& table,
                                const std::vector<std::optional<ResultTable>>& runs) {
  std::vector<NumbersRow> rows;
  for (int c : table.curves) {
    if (!runs[c] || runs[c]->rows.empty()) continue;
    const std::size_t n = runs[c]->rows.size(), first = figure.curves[c].is_sweep() ? 0 : n - 1;
    const std::size_t begin = rows.size();
    for (std::size_t k = first; k < n; ++k) rows.push_back({c, {}});
    for (const NumbersSpec::Column& column : table.columns) {
      const std::vector<double> values = evaluate(column.value, *runs[c]);
      for (std::size_t k = first; k < n; ++k) rows[begin + k - first].numbers.push_back(values[k]);
    }
  }
  return rows;
}

/// The functions that statements are made of, over the curves of one reading.
class Measures {
 public:
  Measures(const FigureSpec& figure, const std::vector<std::optional<ResultTable>>& runs,
           const std::vector<std::vector<DrawnCurve>>& panels)
      : figure_(figure), runs_(runs), panels_(panels) {
    define("first", [](const PlottedPoints& c) { return c.y.front(); });
    define("last", [](const PlottedPoints& c) { return c.y.back(); });
    define("smallest", [](const PlottedPoints& c) { return *std::min_element(c.y.begin(), c.y.end()); });
    define("largest", [](const PlottedPoints& c) { return *std::max_element(c.y.begin(), c.y.end()); });
    define("argmin",
           [](const PlottedPoints& c) { return c.x[std::min_element(c.y.begin(), c.y.end()) - c.y.begin()]; });
    define("argmax",
           [](const PlottedPoints& c) { return c.x[std::max_element(c.y.begin(), c.y.end()) - c.y.begin()]; });
    define("at", [](const PlottedPoints& c, double x) { return interpolate(c, x); });
    define("where", [](const PlottedPoints& c, double level) { return interpolate({c.y, c.x}, level); });
    define("power", [](const PlottedPoints& c, double a, double b) {
      return std::log(interpolate(c, b) / interpolate(c, a)) / std::log(b / a);
    });
    define<&DrawnCurve::misfit>("misfit");
    define<&DrawnCurve::deviation>("deviation");
    define<&DrawnCurve::relative_misfit>("relative_misfit");
  }

  double number(const std::string& formula) {
    missing_ = false;
    parser_.SetExpr(formula);
    const double value = parser_.Eval();
    return missing_ ? none : value;
  }

 private:
  /// Defines a function of a curve and of numbers, the arguments of `measure`, a lambda without captures.
  template <class Measure>
  void define(const char* name, Measure measure) {
    define(name, measure, +measure);
  }
  template <class Measure, class... X>
  void define(const char* name, Measure, double (*)(const PlottedPoints&, X...)) {
    parser_.DefineFunUserData(
        name,
        +[](void* self, const char* curve, X... x) {
          const PlottedPoints points = static_cast<Measures*>(self)->points(curve);
          return points.y.empty() ? none : Measure()(points, x...);
        },
        static_cast<void*>(this), false);
  }

  /// Defines a function of "CURVE: PANEL": a number of the curve as it is drawn there.
  template <double DrawnCurve::*number>
  void define(const char* name) {
    parser_.DefineFunUserData(
        name, +[](void* self, const char* text) { return static_cast<Measures*>(self)->drawn(text, number); },
        static_cast<void*>(this), false);
  }

  /// "CURVE: FORMULA" along the abscissa; empty, and noted, where this reading has no such curve.
  PlottedPoints points(const std::string& text) {
    const auto [curve, formula] = split(text);
    if (!runs_[curve]) {
      missing_ = true;
      return {};
    }
    return {evaluate(figure_.curves[curve].abscissa, *runs_[curve]), evaluate(formula, *runs_[curve])};
  }

  double drawn(const std::string& text, double DrawnCurve::*number) {
    const auto [curve, panel] = split(text);
    if (!runs_[curve]) {
      missing_ = true;
      return none;
    }
    for (std::size_t p = 0; p < figure_.panels.size(); ++p)
      if (figure_.panels[p].name == panel)
        for (const DrawnCurve& c : panels_[p])
          if (c.curve == curve) return c.*number;
    throw std::runtime_error(fmt::format("`{}` is no curve in a panel", text));
  }

  std::pair<int, std::string> split(const std::string& text) const {
    const auto colon = text.find(':');
    const std::string name = text.substr(0, colon);
    for (std::size_t c = 0; c < figure_.curves.size() && colon != std::string::npos; ++c)
      if (figure_.curves[c].name == name) {
        const auto start = text.find_first_not_of(' ', colon + 1);
        return {int(c), start == std::string::npos ? "" : text.substr(start)};
      }
    throw std::runtime_error(fmt::format("`{}` does not begin with the name of a curve and a colon", text));
  }

  const FigureSpec& figure_;
  const std::vector<std::optional<ResultTable>>& runs_;
  const std::vector<std::vector<DrawnCurve>>& panels_;
  mu::Parser parser_;
  bool missing_ = false;
};

}  // namespace

bool Verdict::in_another() const { return std::find(holds.begin() + 1, holds.end(), true) != holds.end(); }

FigureResult evaluate_figure(const FigureSpec& figure, const FigureRuns& runs) {
  FigureResult result;
  std::vector<Complaint> complaints;
  const auto attempt = [&](const std::string& part, auto f) {
    const auto complain = [&](const std::string& why) {
      complaints.push_back({figure.name + "/figure.toml", 0, 0, part + ": " + why});
    };
    try {
      f();
    } catch (const mu::ParserError& e) {
      complain(e.GetMsg());
    } catch (const std::runtime_error& e) {
      complain(e.what());
    }
  };
  result.verdicts.resize(figure.statements.size());
  for (std::size_t r = 0; r < figure.readings.size(); ++r) {
    auto& panels = result.panels.emplace_back();
    for (const Panel& panel : figure.panels) {
      auto& curves = panels.emplace_back();
      for (int c : panel.curves)
        if (runs[r][c] || figure.curves[c].is_measurement())
          attempt(fmt::format("panel `{}`", panel.name),
                  [&] { curves.push_back(draw(panel, figure.curves[c], c, runs[r][c])); });
    }
    auto& tables = result.tables.emplace_back();
    for (const NumbersSpec& table : figure.tables) {
      auto& rows = tables.emplace_back();
      attempt(fmt::format("table \"{}\"", table.title), [&] { rows = rows_of(figure, table, runs[r]); });
    }
    Measures measures(figure, runs[r], panels);
    for (std::size_t s = 0; s < figure.statements.size(); ++s) {
      double number = none;
      if (!figure.statements[s].number.empty())
        attempt(fmt::format("statement \"{}\"", figure.statements[s].text),
                [&] { number = measures.number(figure.statements[s].number); });
      result.verdicts[s].numbers.push_back(number);
      result.verdicts[s].holds.push_back(figure.statements[s].allows(number));
    }
  }
  if (!complaints.empty()) throw InputError(complaints);
  return result;
}

}  // namespace talus
