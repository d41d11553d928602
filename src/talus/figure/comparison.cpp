#include "talus/figure/comparison.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <set>

#include "talus/base/error.hpp"
#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"
#include "talus/figure/panel.hpp"
#include "talus/figure/results.hpp"
#include "talus/output/history.hpp"
#include "talus/output/page.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A folder that is removed with everything in it.
class TemporaryFolder {
 public:
  TemporaryFolder() {
    std::string name = (fs::temp_directory_path() / "talus_XXXXXX").string();
    if (!::mkdtemp(name.data())) throw std::runtime_error("no temporary folder can be made");
    folder_ = name;
  }
  ~TemporaryFolder() {
    std::error_code ignored;
    fs::remove_all(folder_, ignored);
  }
  TemporaryFolder(const TemporaryFolder&) = delete;
  TemporaryFolder& operator=(const TemporaryFolder&) = delete;
  const fs::path& path() const { return folder_; }

 private:
  fs::path folder_;
};

/// One chart: a column over another, of every run that has both.
struct ComparisonChart {
  const char* name;
  const char* caption;
  std::string x, y;
  const char* x_label;
  const char* y_label;
  ResultTable ComparedRun::*table;
};

std::vector<double> column_of(const ResultTable& table, const std::string& name) {
  const int c = table.column(name);
  std::vector<double> values;
  for (const auto& row : table.rows) values.push_back(row[std::size_t(c)]);
  return values;
}

std::vector<ComparisonChart> charts_for(const std::vector<ComparedRun>& runs) {
  const bool has_radius = runs.front().history.column("front_radius") >= 0;
  std::vector<ComparisonChart> charts;
  if (has_radius) {
    charts.push_back({"front_radius", "Radius of the deposit", "time", "front_radius", "time [s]",
                      "radius of the deposit [m]", &ComparedRun::history});
  } else {
    charts.push_back({"front_x_max", "Right front of the deposit", "time", "front_x_max", "time [s]", "right front [m]",
                      &ComparedRun::history});
    charts.push_back({"front_x_min", "Left front of the deposit", "time", "front_x_min", "time [s]", "left front [m]",
                      &ComparedRun::history});
  }
  charts.push_back(
      {"height", "Height of the material", "time", "height", "time [s]", "height [m]", &ComparedRun::history});
  charts.push_back({"kinetic_energy", "Kinetic energy", "time", "kinetic_energy", "time [s]", "kinetic energy [J]",
                    &ComparedRun::history});
  const bool is_plane = runs.front().last_surface.column("x") >= 0;
  charts.push_back({"surface", "Thickness of the material at the last snapshot", is_plane ? "x" : "radius", "thickness",
                    is_plane ? "x [m]" : "radius [m]", "thickness [m]", &ComparedRun::last_surface});
  return charts;
}

std::string cell_with(double x) {
  return std::isfinite(x) ? fmt::format("<td class=\"n\">{:.6g}</td>", x) : "<td class=\"n\">&ndash;</td>";
}

/// A value of record.json by its path, as text; a dash if it is absent.
std::string told(const Json& record, const char* path) {
  const Json::json_pointer pointer(path);
  if (!record.is_object() || !record.contains(pointer)) return "&ndash;";
  const Json& value = record[pointer];
  if (value.is_array()) {
    std::string lines;
    for (const Json& line : value) lines += (lines.empty() ? "" : "<br>") + escaped(line.get<std::string>());
    return lines;
  }
  return escaped(value.is_string()         ? value.get<std::string>()
                 : value.is_number_float() ? fmt::format("{:.4g}", value.get<double>())
                                           : value.dump());
}

/// Settings of a run by their keys, as record.json has them.
std::map<std::string, std::string> settings_of(const ComparedRun& run) {
  std::map<std::string, std::string> settings;
  if (!run.record.is_object() || !run.record.contains("case")) return settings;
  for (const auto& [key, setting] : run.record["case"].items()) settings[key] = setting.value("value", "");
  return settings;
}

std::string head_of_columns(const ComparedRun& a, const ComparedRun& b) {
  return fmt::format("<th>A: {}</th><th>B: {}</th>", escaped(a.name), escaped(b.name));
}

std::string settings_section(const ComparedRun& a, const ComparedRun& b) {
  const auto of_a = settings_of(a), of_b = settings_of(b);
  std::set<std::string> keys;
  for (const auto* settings : {&of_a, &of_b})
    for (const auto& [key, value] : *settings) keys.insert(key);
  std::string different;
  std::size_t n_same = 0;
  for (const std::string& key : keys) {
    const auto value = [&](const auto& settings) {
      return settings.contains(key) ? escaped(settings.at(key)) : "&ndash;";
    };
    if (value(of_a) == value(of_b))
      ++n_same;
    else
      different += fmt::format("<tr><td><code>{}</code></td><td>{}</td><td>{}</td></tr>\n", escaped(key), value(of_a),
                               value(of_b));
  }
  return "<h2>Settings that differ</h2>\n" +
         (different.empty()
              ? "<p>None.</p>\n"
              : "<table><tr><th>key</th>" + head_of_columns(a, b) + "</tr>\n" + different + "</table>\n") +
         fmt::format("<p>{} settings are the same.</p>\n", n_same);
}

std::string outcome_section(const ComparedRun& a, const ComparedRun& b) {
  constexpr std::pair<const char*, const char*> rows[] = {
      {"talus", "/talus"},
      {"build", "/build"},
      {"processor", "/machine/processor"},
      {"threads", "/machine/threads"},
      {"outcome", "/run/outcome"},
      {"failure", "/run/failure"},
      {"particles", "/run/particles"},
      {"steps", "/run/steps"},
      {"simulated time [s]", "/run/simulated_seconds"},
      {"run time [s]", "/run/wall_seconds"},
      {"shortest time step [s]", "/time_step/shortest_seconds"},
      {"mean time step [s]", "/time_step/mean_seconds"},
      {"warnings", "/run/warnings"},
  };
  std::string out = "<h2>Runs</h2>\n<table><tr><th></th>" + head_of_columns(a, b) + "</tr>\n";
  for (const auto& [label, path] : rows)
    out +=
        fmt::format("<tr><td>{}</td><td>{}</td><td>{}</td></tr>\n", label, told(a.record, path), told(b.record, path));
  return out + "</table>\n";
}

std::string differences_section(const ComparedRun& a, const ComparedRun& b) {
  std::string out =
      "<h2>Differences of the histories</h2>\n<p>Values at the last instant that both runs have, and the largest "
      "difference B - A at any instant before; B is interpolated linearly between its rows. The last column is the "
      "largest difference over the largest value.</p>\n<table><tr><th>quantity</th>" +
      head_of_columns(a, b) + "<th>B - A</th><th>largest |B - A|</th><th>at t [s]</th><th>relative</th></tr>\n";
  std::string same;
  for (const ColumnDifference& d : differences(a.history, b.history)) {
    const std::string label = escaped(d.name + (d.unit == "1" ? "" : " [" + d.unit + "]"));
    if (d.largest == 0) {
      same += (same.empty() ? "" : ", ") + label;
      continue;
    }
    out += fmt::format("<tr><td>{}</td>{}{}{}{}{}<td class=\"n\">{:.3g} %</td></tr>\n", label, cell_with(d.end_a),
                       cell_with(d.end_b), cell_with(d.end_b - d.end_a), cell_with(d.largest), cell_with(d.time),
                       100 * d.relative);
  }
  return out + "</table>\n" + (same.empty() ? "" : "<p>No difference: " + same + ".</p>\n");
}

/// Pictures of the same name, side by side.
std::string pictures_section(const ComparedRun& a, const ComparedRun& b) {
  std::set<std::string> names;
  std::error_code none;
  for (const auto& entry : fs::directory_iterator(a.folder / "pictures", none))
    if (entry.path().extension() == ".png" && fs::exists(b.folder / "pictures" / entry.path().filename()))
      names.insert(entry.path().filename().string());
  std::string out;
  for (const std::string& name : names) {
    out += "<div class=\"pair\">\n";
    for (const ComparedRun* run : {&a, &b})
      out += embedded_figure(run->folder / "pictures" / name,
                             (run == &a ? "A: " : "B: ") + run->name + ", " + fs::path(name).stem().string());
    out += "</div>\n";
  }
  return out.empty() ? "" : "<h2>Pictures</h2>\n" + out;
}

/// The value of a column at a time, linear between rows; the rows begin at `row`, which moves on.
double value_at(const std::vector<double>& times, const std::vector<double>& values, double time, std::size_t& row) {
  while (row + 1 < times.size() && times[row + 1] < time) ++row;
  if (row + 1 >= times.size() || time <= times[row]) return values[std::min(row, values.size() - 1)];
  const double part = (time - times[row]) / (times[row + 1] - times[row]);
  return part == 1 ? values[row + 1] : values[row] + part * (values[row + 1] - values[row]);
}

}  // namespace

ComparedRun read_run(const fs::path& folder, const std::string& name) {
  if (!fs::exists(folder / "history.csv"))
    throw InputError(fmt::format("{} holds no results of a run: there is no history.csv", folder.string()));
  ComparedRun run{name, folder, nullptr, read_results(folder / "history.csv"), {}};
  if (run.history.rows.empty()) throw InputError(fmt::format("{}/history.csv has no rows yet", folder.string()));
  if (fs::exists(folder / "record.json")) run.record = Json::parse(contents_of(folder / "record.json"), nullptr, false);
  if (const fs::path profiles = profile_file(folder); fs::exists(profiles))
    if (run.last_surface = read_results(profiles); !run.last_surface.rows.empty()) {
      const double last = run.last_surface.rows.back()[0];
      std::erase_if(run.last_surface.rows, [&](const auto& row) { return row[0] != last; });
    }
  return run;
}

std::string comparison_charts(const std::vector<ComparedRun>& runs) {
  const TemporaryFolder folder;
  std::string out;
  for (const ComparisonChart& chart : charts_for(runs)) {
    FigureSpec figure;
    Panel panel{chart.name, "", {"", chart.x_label, "", false, {}, {}}, {"", chart.y_label, "", false, {}, {}}, {}};
    std::vector<DrawnCurve> curves;
    for (const ComparedRun& run : runs) {
      const ResultTable& table = run.*chart.table;
      if (table.column(chart.x) < 0 || table.column(chart.y) < 0 || table.rows.empty()) continue;
      CurveSpec spec;
      spec.name = spec.label = run.name;
      spec.tests.emplace_back();  // computed, not measured
      figure.curves.push_back(std::move(spec));
      curves.push_back(
          {int(figure.curves.size()) - 1, {column_of(table, chart.x), column_of(table, chart.y)}, {}, 0, 0, 0});
    }
    const auto is_drawn = [](const DrawnCurve& c) {
      return std::any_of(c.computed.y.begin(), c.computed.y.end(), [](double y) { return std::isfinite(y); });
    };
    if (std::none_of(curves.begin(), curves.end(), is_drawn)) continue;
    if (!draw_panel(folder.path(), figure, panel, curves)) return "";
    out += embedded_figure(folder.path() / (panel.name + ".svg"), chart.caption);
  }
  return "<div class=\"charts\">\n" + out + "</div>\n";
}

std::vector<ColumnDifference> differences(const ResultTable& a, const ResultTable& b) {
  const std::vector<double> times_a = column_of(a, "time"), times_b = column_of(b, "time");
  const double end = std::min(times_a.back(), times_b.back());
  std::vector<ColumnDifference> all;
  for (std::size_t c = 0; c < a.names.size(); ++c) {
    if (a.names[c] == "time" || a.names[c] == "step" || a.names[c] == "dt" || b.column(a.names[c]) < 0) continue;
    const std::vector<double> values_a = column_of(a, a.names[c]), values_b = column_of(b, a.names[c]);
    constexpr double nan = std::numeric_limits<double>::quiet_NaN();
    ColumnDifference d{a.names[c], a.units[c], nan, nan, 0, 0, 0};
    double scale = 0;
    std::size_t in_a = 0, in_b = 0;
    const auto compare = [&](double t) {
      d.end_a = value_at(times_a, values_a, t, in_a);
      d.end_b = value_at(times_b, values_b, t, in_b);
      if (!std::isfinite(d.end_a) || !std::isfinite(d.end_b)) return;
      scale = std::max({scale, std::abs(d.end_a), std::abs(d.end_b)});
      if (std::abs(d.end_b - d.end_a) > d.largest) {
        d.largest = std::abs(d.end_b - d.end_a);
        d.time = t;
      }
    };
    for (double t : times_a)
      if (t < end) compare(t);
    compare(end);
    d.relative = scale > 0 ? d.largest / scale : 0;
    all.push_back(d);
  }
  return all;
}

std::string comparison_page(const ComparedRun& a, const ComparedRun& b) {
  const std::string charts = comparison_charts({a, b});
  return page_head(fmt::format("{} and {} compared", a.name, b.name),
                   ".pair { display: grid; grid-template-columns: 1fr 1fr; gap: 1rem; }") +
         fmt::format(
             "<h1>{} and {} compared</h1>\n<p>A: <code>{}</code><br>B: <code>{}</code><br>Compared by talus "
             "{}.</p>\n",
             escaped(a.name), escaped(b.name), escaped(fs::absolute(a.folder).lexically_normal().string()),
             escaped(fs::absolute(b.folder).lexically_normal().string()), escaped(version())) +
         settings_section(a, b) + outcome_section(a, b) + differences_section(a, b) + "<h2>Charts</h2>\n" +
         (charts.empty() ? "<p>No charts: gnuplot is not installed.</p>\n" : charts) + pictures_section(a, b) +
         "</body></html>\n";
}

}  // namespace talus
