#include "talus/calibration/parameters.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "talus/base/error.hpp"
#include "talus/base/table.hpp"
#include "talus/base/units.hpp"
#include "talus/case/material.hpp"

namespace talus {

namespace {

constexpr double degree = std::numbers::pi / 180;

/// Bounds that hold soils and grains, and the stage of a parameter.
struct Known {
  std::string_view key;
  double min, max;
  Stage stage;
};
constexpr Known known[] = {
    {"E0", 5, 2000, Stage::elasticity},
    {"E", 1e5, 1e11, Stage::elasticity},
    {"K", 1e4, 1e10, Stage::elasticity},
    {"nu", 0.05, 0.45, Stage::elasticity},
    {"n", 0.1, 0.95, Stage::elasticity},
    {"phi_c", 15 * degree, 45 * degree, Stage::critical_state},
    {"phi", 10 * degree, 55 * degree, Stage::critical_state},
    {"c", 0, 1e5, Stage::critical_state},
    {"e_ref", 0.3, 2, Stage::critical_state},
    {"Lambda", 1e-3, 0.5, Stage::critical_state},
    {"xi", 0.1, 1.5, Stage::critical_state},
    {"A_d", 0.05, 10, Stage::peak_and_dilatancy},
    {"n_p", 0, 10, Stage::peak_and_dilatancy},
    {"n_d", 0, 10, Stage::peak_and_dilatancy},
    {"psi", 0, 30 * degree, Stage::peak_and_dilatancy},
    {"k_p", 1e-4, 0.2, Stage::hardening},
    {"mu_s", 0.1, 1, Stage::rate},
    {"mu_d", 0.2, 2.5, Stage::rate},
    {"I_0", 0.01, 3, Stage::rate},
    {"Phi_c", 0.55, 0.78, Stage::rate},
    {"dPhi", 0.01, 1, Stage::rate},
    {"eta", 1e-6, 1e6, Stage::rate},
};
const Known* find_known(std::string_view key) {
  const auto* found = std::find_if(std::begin(known), std::end(known), [&](const Known& k) { return k.key == key; });
  return found == std::end(known) ? nullptr : found;
}

}  // namespace

std::vector<NamedValue> parameters_of(const AnyLaw& law) {
  return std::visit(
      []<class Law>(Law l) {
        std::vector<NamedValue> all;
        for (const auto& p : Law::parameters()) all.push_back({p, p.value(l)});
        return all;
      },
      law);
}

void set_parameters(AnyLaw& law, const std::vector<std::pair<std::string, double>>& values) {
  std::visit(
      [&]<class Law>(Law& l) {
        for (const auto& [key, value] : values)
          for (const auto& p : Law::parameters())
            if (p.key == key) p.value(l) = value;
        l.prepare();
      },
      law);
}

std::vector<std::pair<std::string, std::string>> options_of(const AnyLaw& law) {
  return std::visit(
      []<class Law>(const Law& l) {
        std::vector<std::pair<std::string, std::string>> all;
        for (const auto& o : Law::options())
          all.emplace_back(std::string(o.key), std::string(o.choices[std::size_t(o.get(l))].word));
        return all;
      },
      law);
}

std::string fault_of(const AnyLaw& law, const std::vector<double>& void_ratios) {
  for (const NamedValue& v : parameters_of(law))
    if (!v.parameter.range.contains(v.value))
      return fmt::format("{} = {:g} is out of its range", v.parameter.key, v.value);
  const std::string together = std::visit(
      [](const auto& l) -> std::string {
        if constexpr (requires { l.fault(); })
          if (const std::optional<Fault> fault = l.fault()) return fmt::format("{} {}", fault->key, fault->why);
        return "";
      },
      law);
  if (!together.empty()) return together;
  for (double e : void_ratios)
    if (const std::string why = fault_of_void_ratio(law, e); !why.empty())
      return fmt::format("a void ratio of {:.4g} {}", e, why);
  return "";
}

std::optional<Range> default_bounds(const Parameter& p) {
  if (const Known* k = find_known(p.key)) {
    Range bounds = Range::between(std::max(k->min, p.range.low), std::min(k->max, p.range.high));
    if (bounds.low < bounds.high) return bounds;
  }
  if (std::isfinite(p.range.low) && std::isfinite(p.range.high)) {
    const double margin = 1e-3 * (p.range.high - p.range.low);  // an open end is no value
    return Range::between(p.range.low + (p.range.open_low ? margin : 0),
                          p.range.high - (p.range.open_high ? margin : 0));
  }
  return std::nullopt;
}

Stage default_stage(std::string_view key) {
  const Known* k = find_known(key);
  return k ? k->stage : Stage::rate;
}

double to_coordinate(const FreeParameter& p, double value) {
  if (p.logarithmic) return std::log(value / p.min) / std::log(p.max / p.min);
  return (value - p.min) / (p.max - p.min);
}

double from_coordinate(const FreeParameter& p, double x) {
  if (x <= 0) return p.min;
  if (x >= 1) return p.max;
  if (p.logarithmic) return p.min * std::pow(p.max / p.min, x);
  return p.min + x * (p.max - p.min);
}

double slope_of(const FreeParameter& p, double x) {
  return p.logarithmic ? from_coordinate(p, x) * std::log(p.max / p.min) : p.max - p.min;
}

double value_of_tie(const TiedParameter& tie, const AnyLaw& law) {
  NumberTable table;
  table.rows.emplace_back();
  for (const NamedValue& v : parameters_of(law)) {
    table.names.emplace_back(v.parameter.key);
    table.rows[0].push_back(v.value);
  }
  if (const std::optional<double> friction = critical_friction_of(law)) {
    table.names.emplace_back("critical_friction");
    table.rows[0].push_back(*friction);
  }
  return evaluate(tie.formula, table)[0];
}

AnyLaw law_at(const Calibration& calibration, const Vector& x) {
  AnyLaw law = calibration.law;
  std::vector<std::pair<std::string, double>> values;
  for (std::size_t i = 0; i < calibration.free.size(); ++i)
    values.emplace_back(calibration.free[i].key, from_coordinate(calibration.free[i], x[Eigen::Index(i)]));
  set_parameters(law, values);
  values.clear();
  for (const TiedParameter& tie : calibration.tied) values.emplace_back(tie.key, value_of_tie(tie, law));
  if (!values.empty()) set_parameters(law, values);
  return law;
}

std::string rounded_with_unit(double value, std::string_view unit, int digits) {
  if (!std::isfinite(value)) return "-";
  if (unit == "rad") return fmt::format("{:.{}g} deg", value / degree, digits);
  return with_unit(std::stod(fmt::format("{:.{}g}", value, digits)), unit);
}

std::vector<double> void_ratios_of_tests(const Calibration& calibration) {
  std::vector<double> all;
  for (const MeasuredTest& test : calibration.tests) {
    if (test.kind == TestKind::grain_shear)
      for (const ShearedState& s : test.states) all.push_back(s.void_ratio);
    else
      all.push_back(test.void_ratio);
  }
  std::erase_if(all, [](double e) { return !(e > 0); });
  std::sort(all.begin(), all.end());
  if (all.size() > 2) all = {all.front(), all.back()};
  return all;
}

}  // namespace talus
