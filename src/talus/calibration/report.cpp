#include "talus/calibration/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"
#include "talus/base/units.hpp"
#include "talus/calibration/page.hpp"
#include "talus/case/material.hpp"
#include "talus/law/constants.hpp"
#include "talus/law/point.hpp"

namespace talus {

namespace {

using Json = nlohmann::ordered_json;

/// A number with its unit as an input file has it: five digits, quoted where it has a unit.
std::string in_file(double value, std::string_view unit) {
  if (unit == "1") return fmt::format("{:.5g}", value);
  if (unit == "rad") return fmt::format("\"{:.5g} deg\"", value * 180 / std::numbers::pi);
  return fmt::format("\"{:.5g} {}\"", value, unit);
}

Json json_or_null(double x) { return std::isfinite(x) ? Json(x) : Json(); }

/// Where a parameter stands among the free or the tied ones; -1 if it is not there.
template <class Parameters>
int index_of(std::string_view key, const Parameters& parameters) {
  for (std::size_t i = 0; i < parameters.size(); ++i)
    if (parameters[i].key == key) return int(i);
  return -1;
}

/// Which bound a parameter has hit, as tables name it.
std::string_view bound_of(const ParameterEstimate& e) { return e.at_min ? "min" : e.at_max ? "max" : ""; }

std::string csv_cell(const std::string& text) { return text.find(',') == text.npos ? text : "\"" + text + "\""; }

std::string misfits_csv(const Calibration& c, const CalibrationResult& r) {
  std::string csv = "test,group,kind,quantity,weight,scale,unit,misfit_start,misfit_fitted,misfit_left_out\n";
  for (std::size_t t = 0; t < c.tests.size(); ++t) {
    const MeasuredTest& test = c.tests[t];
    const std::optional<LeftOutMisfit> left_out = left_out_misfit(r, t);
    const double without = left_out ? left_out->without : std::nan("");
    for (std::size_t k = 0; k < test.quantities.size(); ++k) {
      const MeasuredQuantity& q = test.quantities[k];
      csv += fmt::format("{},{},{},{},{:g},{:.6g},{},{:.6g},{:.6g},{:.6g}\n", csv_cell(test.name), csv_cell(test.group),
                         test_kind_choices[int(test.kind)].word, q.name, q.weight, q.scale,
                         q.logarithmic ? "logarithm" : q.unit, r.tests[t].misfits_start[k],
                         r.tests[t].misfits_fitted[k], without);
    }
  }
  return csv;
}

/// The header of a table with a column for each free parameter.
std::string parameter_header(const std::string& first, const Calibration& c) {
  std::string header = first;
  for (const FreeParameter& p : c.free) header += "," + p.key;
  return header + "\n";
}

std::string correlation_csv(const Calibration& c, const CalibrationResult& r) {
  std::string csv = parameter_header("parameter", c);
  for (std::size_t i = 0; i < c.free.size(); ++i) {
    csv += c.free[i].key;
    for (std::size_t j = 0; j < c.free.size(); ++j)
      csv += fmt::format(",{:.4f}", r.statistics.correlation(Eigen::Index(i), Eigen::Index(j)));
    csv += "\n";
  }
  return csv;
}

std::string information_csv(const Calibration& c, const CalibrationResult& r) {
  std::string csv = parameter_header("test", c);
  for (std::size_t t = 0; t < c.tests.size(); ++t) {
    csv += csv_cell(c.tests[t].name);
    for (std::size_t p = 0; p < c.free.size(); ++p)
      csv += fmt::format(",{:.5f}", r.statistics.information(Eigen::Index(t), Eigen::Index(p)));
    csv += "\n";
  }
  return csv;
}

std::string parameters_csv(const Calibration& c, const CalibrationResult& r) {
  std::string csv = "parameter,unit,start,value,standard_error,jackknife_error,min,max,at_bound\n";
  for (std::size_t i = 0; i < c.free.size(); ++i) {
    const ParameterEstimate& e = r.statistics.parameters[i];
    csv += fmt::format("{},{},{:.8g},{:.8g},{:.4g},{:.4g},{:.8g},{:.8g},{}\n", c.free[i].key, c.free[i].unit,
                       c.free[i].start, e.value, e.standard_error,
                       r.jackknife.size() > 0 ? r.jackknife[Eigen::Index(i)] : std::nan(""), c.free[i].min,
                       c.free[i].max, bound_of(e));
  }
  return csv;
}

}  // namespace

std::string material_block(const Calibration& c, const CalibrationResult& r) {
  std::string text = fmt::format(
      "# {}\n# calibrated with talus {} from {} tests; root mean square misfit {:.3g} (start: "
      "{:.3g})\n[material.NAME]\nlaw = \"{}\"\n",
      c.title, version(), c.tests.size(), std::sqrt(r.objective), std::sqrt(r.objective_start), name_of(r.law));
  for (const auto& [p, value] : parameters_of(r.law)) {
    std::string why = "fixed";
    if (const int i = index_of(p.key, c.free); i >= 0) {
      const ParameterEstimate& e = r.statistics.parameters[std::size_t(i)];
      why = e.at_min || e.at_max ? fmt::format("at its {} bound", e.at_min ? "lower" : "upper")
            : !e.informed        ? "not identifiable: no test depends on it"
                                 : fmt::format("standard error {}", rounded_with_unit(e.standard_error, p.unit, 2));
      for (const auto& group : r.statistics.inseparable)
        if (std::find(group.begin(), group.end(), i) != group.end()) {
          std::vector<std::string> others;
          for (int other : group)
            if (other != i) others.push_back(c.free[std::size_t(other)].key);
          why += fmt::format("; not separable from {}", fmt::join(others, ", "));
        }
    } else if (const int tie = index_of(p.key, c.tied); tie >= 0) {
      why = "= " + c.tied[std::size_t(tie)].formula;
    }
    text += fmt::format("{:<32} # {}\n", fmt::format("{} = {}", p.key, in_file(value, p.unit)), why);
  }
  for (const auto& [key, word] : options_of(r.law)) text += fmt::format("{} = \"{}\"\n", key, word);
  return text;
}

std::string user_material(const Calibration& c, const CalibrationResult& r) {
  MaterialConstants material;
  material.law = r.law;
  const std::vector<NamedConstant> all = constants_of(material);
  std::string text = fmt::format(
      "** {}\n** law `{}` of talus {} for libtalus_umat.so; SI units, angles in rad\n** constants in this order:\n",
      c.title, name_of(r.law), version());
  for (std::size_t i = 0; i < all.size(); ++i)
    text += fmt::format("** {:>3} {:<8} [{}] {}\n", i + 1, all[i].name, all[i].unit, all[i].meaning);
  for (const auto& [key, word] : options_of(r.law)) text += fmt::format("** option {} = \"{}\"\n", key, word);
  if (void_ratios_of(r.law))
    text += "** void_ratio is to be set: here, or as the first solution-dependent state variable\n";
  text += fmt::format("*DEPVAR\n{}\n", 2 + state_size_of(r.law));
  text += fmt::format("*USER MATERIAL, CONSTANTS={}, UNSYMM\n", all.size());
  for (std::size_t i = 0; i < all.size(); ++i)
    text += fmt::format("{:.8g}{}", all[i].value, i + 1 == all.size() ? "\n" : (i + 1) % 8 == 0 ? ",\n" : ", ");
  return text;
}

std::string result_as_json(const Calibration& c, const CalibrationResult& r) {
  Json json;
  json["title"] = c.title;
  json["version"] = version();
  json["law"] = name_of(r.law);
  json["seconds"] = r.seconds;
  json["threads"] = r.threads;
  json["evaluations"] = r.evaluations;
  json["misfit"] = {{"start", std::sqrt(r.objective_start)}, {"fitted", std::sqrt(r.objective)}};
  for (const MeanMisfit& m : mean_misfits(c, r))
    json["mean_misfits"].push_back({{"kind", m.kind},
                                    {"quantity", m.quantity},
                                    {"fitted_quantity", m.is_fitted},
                                    {"tests", m.n_tests},
                                    {"start", m.start},
                                    {"fitted", m.fitted}});
  for (std::size_t i = 0; i < c.free.size(); ++i) {
    const FreeParameter& p = c.free[i];
    const ParameterEstimate& e = r.statistics.parameters[i];
    json["parameters"].push_back(
        {{"key", p.key},
         {"unit", p.unit},
         {"value", e.value},
         {"standard_error", json_or_null(e.standard_error)},
         {"jackknife_error", r.jackknife.size() > 0 ? json_or_null(r.jackknife[Eigen::Index(i)]) : Json()},
         {"start", p.start},
         {"min", p.min},
         {"max", p.max},
         {"at_bound", bound_of(e)},
         {"informed", e.informed}});
  }
  json["tied"] = Json::array();
  for (std::size_t i = 0; i < c.tied.size(); ++i)
    json["tied"].push_back({{"key", c.tied[i].key},
                            {"formula", c.tied[i].formula},
                            {"value", r.statistics.tied_values[i]},
                            {"standard_error", json_or_null(r.statistics.tied_errors[i])}});
  for (const NamedValue& v : parameters_of(r.law))
    json["props"].push_back({{"key", v.parameter.key}, {"value", v.value}});
  json["correlation"] = Json::array();
  for (std::size_t i = 0; i < c.free.size(); ++i) {
    Json row = Json::array();
    for (std::size_t j = 0; j < c.free.size(); ++j)
      row.push_back(json_or_null(r.statistics.correlation(Eigen::Index(i), Eigen::Index(j))));
    json["correlation"].push_back(row);
  }
  json["findings"] = r.findings;
  const auto names_of = [&](const std::vector<int>& parameters) {
    Json names = Json::array();
    for (int p : parameters) names.push_back(c.free[std::size_t(p)].key);
    return names;
  };
  json["inseparable"] = Json::array();
  for (const auto& group : r.statistics.inseparable) json["inseparable"].push_back(names_of(group));
  json["suggestions"] = Json::array();
  for (const Suggestion& s : r.suggestions)
    json["suggestions"].push_back({{"parameters", names_of(s.parameters)}, {"test", s.test}, {"factor", s.factor}});
  for (const FinishedStart& s : r.starts) {
    Json values = Json::object();
    for (std::size_t i = 0; i < c.free.size(); ++i)
      values[c.free[i].key] = from_coordinate(c.free[i], s.x[Eigen::Index(i)]);
    json["starts"].push_back(
        {{"misfit", std::sqrt(s.objective)}, {"evaluations", s.evaluations}, {"parameters", values}});
  }
  for (std::size_t t = 0; t < c.tests.size(); ++t) {
    Json quantities = Json::object();
    for (std::size_t k = 0; k < c.tests[t].quantities.size(); ++k)
      quantities[c.tests[t].quantities[k].name] = {{"weight", c.tests[t].quantities[k].weight},
                                                   {"start", r.tests[t].misfits_start[k]},
                                                   {"fitted", r.tests[t].misfits_fitted[k]}};
    json["tests"].push_back({{"name", c.tests[t].name},
                             {"kind", test_kind_choices[int(c.tests[t].kind)].word},
                             {"rows", c.tests[t].n_rows()},
                             {"failure", r.tests[t].fitted.failure},
                             {"misfits", quantities}});
  }
  json["left_out"] = Json::array();
  for (const LeftOut& l : r.left_out)
    for (std::size_t i = 0; i < l.tests.size(); ++i)
      json["left_out"].push_back({{"group", l.group},
                                  {"test", c.tests[std::size_t(l.tests[i])].name},
                                  {"misfit_fitted", l.misfits_with[i]},
                                  {"misfit_predicted", l.misfits_without[i]}});
  return json.dump(1) + "\n";
}

std::optional<LeftOutMisfit> left_out_misfit(const CalibrationResult& r, std::size_t test) {
  for (const LeftOut& l : r.left_out)
    for (std::size_t i = 0; i < l.tests.size(); ++i)
      if (l.tests[i] == int(test)) return LeftOutMisfit{l.misfits_with[i], l.misfits_without[i]};
  return std::nullopt;
}

std::vector<MeanMisfit> mean_misfits(const Calibration& c, const CalibrationResult& r) {
  std::vector<MeanMisfit> all;
  for (std::size_t t = 0; t < c.tests.size(); ++t)
    for (std::size_t k = 0; k < c.tests[t].quantities.size(); ++k) {
      const std::string kind(test_kind_choices[int(c.tests[t].kind)].word);
      const MeasuredQuantity& q = c.tests[t].quantities[k];
      auto found = std::find_if(all.begin(), all.end(),
                                [&](const MeanMisfit& m) { return m.kind == kind && m.quantity == q.name; });
      if (found == all.end()) found = all.insert(all.end(), {kind, q.name, 0, 0, 0, false});
      found->start += r.tests[t].misfits_start[k];
      found->fitted += r.tests[t].misfits_fitted[k];
      ++found->n_tests;
      found->is_fitted = found->is_fitted || q.weight > 0;
    }
  for (MeanMisfit& m : all) {
    m.start /= m.n_tests;
    m.fitted /= m.n_tests;
  }
  return all;
}

std::string result_in_words(const Calibration& c, const CalibrationResult& r) {
  std::string text =
      fmt::format("{:<10} {:>14} {:>14} {:>14}  {}\n", "parameter", "start", "value", "std. error", "bounds");
  for (std::size_t i = 0; i < c.free.size(); ++i) {
    const FreeParameter& p = c.free[i];
    const ParameterEstimate& e = r.statistics.parameters[i];
    text += fmt::format("{:<10} {:>14} {:>14} {:>14}  {} to {}{}\n", p.key, rounded_with_unit(p.start, p.unit, 5),
                        rounded_with_unit(e.value, p.unit, 5), rounded_with_unit(e.standard_error, p.unit, 2),
                        rounded_with_unit(p.min, p.unit, 4), rounded_with_unit(p.max, p.unit, 4),
                        e.at_min   ? "  AT THE LOWER BOUND"
                        : e.at_max ? "  AT THE UPPER BOUND"
                                   : "");
  }
  for (std::size_t i = 0; i < c.tied.size(); ++i)
    text += fmt::format("{:<10} {:>14} {:>14} {:>14}  = {}\n", c.tied[i].key, "",
                        rounded_with_unit(r.statistics.tied_values[i], c.tied[i].unit, 5),
                        rounded_with_unit(r.statistics.tied_errors[i], c.tied[i].unit, 2), c.tied[i].formula);
  text += fmt::format("\n{:<24} {:<22} {:>6} {:>10} {:>10}\n", "mean misfit", "quantity", "tests", "start", "fitted");
  for (const MeanMisfit& m : mean_misfits(c, r))
    text += fmt::format("{:<24} {:<22} {:>6} {:>10.3f} {:>10.3f}{}\n", m.kind, m.quantity, m.n_tests, m.start, m.fitted,
                        m.is_fitted ? "" : "  (weight 0)");
  if (!r.left_out.empty()) {
    double with = 0, without = 0;
    int n = 0;
    for (const LeftOut& l : r.left_out)
      for (std::size_t i = 0; i < l.tests.size(); ++i, ++n) {
        with += l.misfits_with[i];
        without += l.misfits_without[i];
      }
    text += fmt::format("\npredicted without itself: mean misfit of a test {:.3f}; fitted: {:.3f}\n", without / n,
                        with / n);
  }
  if (!r.findings.empty()) text += "\n";
  for (const std::string& finding : r.findings) text += "- " + finding + "\n";
  for (const Suggestion& s : r.suggestions) text += "- " + suggestion_in_words(c, s) + "\n";
  return text;
}

bool write_report(const std::filesystem::path& folder, const Calibration& c, const CalibrationResult& r) {
  write_whole(folder / "material.toml", material_block(c, r));
  write_whole(folder / "user_material.inp", user_material(c, r));
  write_whole(folder / "result.json", result_as_json(c, r));
  write_whole(folder / "parameters.csv", parameters_csv(c, r));
  write_whole(folder / "misfits.csv", misfits_csv(c, r));
  write_whole(folder / "correlation.csv", correlation_csv(c, r));
  write_whole(folder / "information.csv", information_csv(c, r));
  const bool drawn = draw_tests(folder, c, r);
  write_whole(folder / "index.html", calibration_page(folder, c, r, drawn));
  return drawn;
}

}  // namespace talus
