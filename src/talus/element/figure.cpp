#include "talus/element/figure.hpp"

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
double interpolate(const Points& line, double x) {
  for (std::size_t i = 1; i < line.x.size(); ++i) {
    const double a = line.x[i - 1], b = line.x[i];
    if ((a <= x && x <= b) || (b <= x && x <= a))
      return a == b ? line.y[i] : line.y[i - 1] + (x - a) / (b - a) * (line.y[i] - line.y[i - 1]);
  }
  return none;
}

/// rms distance of a line from points, over the largest point. Points beyond the line count as far off as its end.
double misfit_of(const Points& line, const Points& points) {
  double sum = 0, largest = 0;
  int n = 0;
  for (std::size_t i = 0; i < points.x.size(); ++i) {
    if (!std::isfinite(points.x[i]) || !std::isfinite(points.y[i]) || line.y.empty()) continue;
    double y = interpolate(line, points.x[i]);
    if (!std::isfinite(y)) {
      const bool nearer_end = std::abs(points.x[i] - line.x.back()) <= std::abs(points.x[i] - line.x.front());
      y = nearer_end ? line.y.back() : line.y.front();
    }
    sum += (y - points.y[i]) * (y - points.y[i]);
    largest = std::max(largest, std::abs(points.y[i]));
    ++n;
  }
  return n > 0 && largest > 0 ? std::sqrt(sum / n) / largest : none;
}

DrawnCurve draw(const FigureSpec& figure, const Panel& panel, int curve, const ResultTable& result) {
  DrawnCurve drawn{curve, {evaluate(panel.x.value, result), evaluate(panel.y.value, result)}, {}, none};
  const auto& measured = figure.curves[curve].measured;
  if (measured && !panel.x.measured.empty() && !panel.y.measured.empty()) {
    drawn.measured = {evaluate(panel.x.measured, *measured), evaluate(panel.y.measured, *measured)};
    drawn.misfit = misfit_of(drawn.computed, drawn.measured);
  }
  return drawn;
}

/// The functions that statements are made of, over the curves of one reading.
class Measures {
 public:
  Measures(const FigureSpec& figure, const std::vector<std::optional<ResultTable>>& runs,
           const std::vector<std::vector<DrawnCurve>>& panels)
      : figure_(figure), runs_(runs), panels_(panels) {
    define("first", [](const Points& c) { return c.y.front(); });
    define("last", [](const Points& c) { return c.y.back(); });
    define("smallest", [](const Points& c) { return *std::min_element(c.y.begin(), c.y.end()); });
    define("largest", [](const Points& c) { return *std::max_element(c.y.begin(), c.y.end()); });
    define("argmin", [](const Points& c) { return c.x[std::min_element(c.y.begin(), c.y.end()) - c.y.begin()]; });
    define("argmax", [](const Points& c) { return c.x[std::max_element(c.y.begin(), c.y.end()) - c.y.begin()]; });
    define("at", [](const Points& c, double x) { return interpolate(c, x); });
    define("where", [](const Points& c, double level) { return interpolate({c.y, c.x}, level); });
    define("power", [](const Points& c, double a, double b) {
      return std::log(interpolate(c, b) / interpolate(c, a)) / std::log(b / a);
    });
    parser_.DefineFunUserData(
        "misfit", +[](void* self, const char* curve) { return static_cast<Measures*>(self)->misfit(curve); },
        static_cast<void*>(this), false);
  }

  double number(const std::string& formula) {
    missing_ = false;
    parser_.SetExpr(formula);
    const double value = parser_.Eval();
    return missing_ ? none : value;
  }

 private:
  /// Tells muParser of a function of a curve and of as many numbers as `measure`, a lambda without captures, takes.
  template <class Measure>
  void define(const char* name, Measure measure) {
    define(name, measure, +measure);
  }
  template <class Measure, class... X>
  void define(const char* name, Measure, double (*)(const Points&, X...)) {
    parser_.DefineFunUserData(
        name,
        +[](void* self, const char* curve, X... x) {
          const Points points = static_cast<Measures*>(self)->points(curve);
          return points.y.empty() ? none : Measure()(points, x...);
        },
        static_cast<void*>(this), false);
  }

  /// "CURVE: FORMULA" along the abscissa; empty, and noted, where this reading has no such curve.
  Points points(const std::string& text) {
    const auto [curve, formula] = split(text);
    if (!runs_[curve]) {
      missing_ = true;
      return {};
    }
    return {evaluate(figure_.abscissa, *runs_[curve]), evaluate(formula, *runs_[curve])};
  }

  double misfit(const std::string& text) {
    const auto [curve, panel] = split(text);
    for (std::size_t p = 0; p < figure_.panels.size(); ++p)
      if (figure_.panels[p].name == panel)
        for (const DrawnCurve& c : panels_[p])
          if (c.curve == curve) return c.misfit;
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
  const auto attempt = [&](const std::string& what, auto f) {
    const auto complain = [&](const std::string& why) {
      complaints.push_back({figure.name + "/figure.toml", 0, 0, what + ": " + why});
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
        if (runs[r][c])
          attempt(fmt::format("panel `{}`", panel.name),
                  [&] { curves.push_back(draw(figure, panel, c, *runs[r][c])); });
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
