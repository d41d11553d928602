#include "talus/app/sweep_plan.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstdlib>
#include <set>

#include "talus/base/error.hpp"
#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"
#include "talus/figure/comparison.hpp"
#include "talus/input/read.hpp"
#include "talus/output/page.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

/// A text as a part of a folder's name: "20 deg" -> "20_deg".
std::string part_of_name(const std::string& text) {
  std::string name;
  for (char c : text)
    if (std::isalnum(static_cast<unsigned char>(c)) || c == '.' || c == '-' || c == '+')
      name += c;
    else if (!name.empty() && name.back() != '_')
      name += '_';
  while (!name.empty() && name.back() == '_') name.pop_back();
  return name.substr(0, 60);
}

/// The last part of a key, or the last two where others of the sweep end alike.
std::string short_key(const std::vector<OverrideSeries>& series, std::size_t number) {
  const auto last = [](const std::string& key) { return key.substr(key.rfind('.') + 1); };
  const std::string& key = series[number].key;
  for (std::size_t i = 0; i < series.size(); ++i)
    if (i != number && last(series[i].key) == last(key)) return part_of_name(key);
  return part_of_name(last(key));
}

/// The combination of values with this number; the last series changes fastest.
std::vector<Override> combination(const std::vector<OverrideSeries>& series, std::size_t number) {
  std::vector<Override> chosen(series.size());
  for (std::size_t i = series.size(); i-- > 0;) {
    chosen[i] = series[i].overrides[number % series[i].overrides.size()];
    number /= series[i].overrides.size();
  }
  return chosen;
}

Sweep plan(std::string case_file, std::string case_text, std::vector<OverrideSeries> series, fs::path folder) {
  constexpr std::size_t most_runs = 10000;
  Sweep sweep{std::move(folder), std::move(case_file), std::move(case_text), std::move(series), {}};
  std::size_t n = 1;
  for (const OverrideSeries& s : sweep.series) {
    expect_table_of(s.overrides.front(), sweep.case_file, sweep.case_text);
    if ((n *= s.overrides.size()) > most_runs)
      throw InputError(fmt::format("the sweep has more than {} runs; give fewer values", most_runs));
  }
  std::set<std::string> names, texts;
  std::vector<Complaint> complaints;
  for (std::size_t k = 0; k < n; ++k) {
    SweepRun run;
    const std::vector<Override> overrides = combination(sweep.series, k);
    std::vector<std::string> parts;
    for (std::size_t i = 0; i < overrides.size(); ++i) {
      run.settings.emplace_back(sweep.series[i].key, overrides[i].value);
      parts.push_back(short_key(sweep.series, i) + "_" + part_of_name(in_words(overrides[i].value)));
    }
    run.name = fmt::format("{}", fmt::join(parts, "__"));
    for (int number = 2; names.contains(run.name); ++number)
      run.name = fmt::format("{}_{}", fmt::join(parts, "__"), number);
    names.insert(run.name);
    run.text = with_overrides(sweep.case_file, sweep.case_text, overrides);
    if (!texts.insert(run.text).second)
      throw InputError(fmt::format("--set {} has a value twice", sweep.series.back().key));
    try {
      read_case_text(fmt::format("{} with {}", sweep.case_file, run.name), run.text);
    } catch (const InputError& e) {
      complaints.insert(complaints.end(), e.complaints().begin(), e.complaints().end());
    }
    sweep.runs.push_back(std::move(run));
  }
  if (!complaints.empty()) throw InputError(complaints);
  return sweep;
}

/// A number and its unit, if a value is one with at most one unit: "20 deg" -> 20, "deg"; 0.5 -> 0.5, "".
struct NumberWithUnit {
  double number;
  std::string unit;
};
std::optional<NumberWithUnit> number_with_unit(const std::string& words) {
  if (words.find_first_of("0123456789.+-") != 0) return std::nullopt;
  char* rest = nullptr;
  const double number = std::strtod(words.c_str(), &rest);
  if (rest == words.c_str() || (*rest != 0 && *rest != ' ' && !std::isalpha(static_cast<unsigned char>(*rest))))
    return std::nullopt;
  const std::string unit(rest + (*rest == ' ' ? 1 : 0));
  return NumberWithUnit{number, unit};
}

std::string quoted_for_csv(const std::string& text) {
  if (text.find_first_of(",\"\n") == text.npos) return text;
  std::string quoted = "\"";
  for (char c : text) quoted += c == '"' ? std::string("\"\"") : std::string(1, c == '\n' ? ' ' : c);
  return quoted + "\"";
}

/// Headers and cells; a setting is a number with its unit in the header where all runs have the same unit.
struct Cells {
  std::vector<std::string> header;
  std::vector<std::vector<std::string>> rows;
};
Cells settings_in_cells(const Sweep& sweep) {
  Cells cells{{}, std::vector<std::vector<std::string>>(sweep.runs.size())};
  for (std::size_t i = 0; i < sweep.series.size(); ++i) {
    std::set<std::string> units;
    for (const Override& o : sweep.series[i].overrides) {
      const auto value = number_with_unit(in_words(o.value));
      units.insert(value ? value->unit : "no number");
    }
    const bool is_number = units.size() == 1 && !units.contains("no number");
    const std::string unit = is_number && !units.begin()->empty() ? " [" + *units.begin() + "]" : "";
    cells.header.push_back(sweep.series[i].key + unit);
    for (std::size_t k = 0; k < sweep.runs.size(); ++k) {
      const std::string words = in_words(sweep.runs[k].settings[i].second);
      cells.rows[k].push_back(is_number ? fmt::format("{:.15g}", number_with_unit(words)->number) : words);
    }
  }
  return cells;
}

/// The last rows of the histories, with the columns of all of them, and numbers of the records.
Cells results_in_cells(const Sweep& sweep) {
  constexpr std::pair<const char*, const char*> of_record[] = {
      {"particles", "/run/particles"}, {"steps", "/run/steps"}, {"wall_time [s]", "/run/wall_seconds"}};
  Cells cells{{}, std::vector<std::vector<std::string>>(sweep.runs.size())};
  std::vector<std::optional<ComparedRun>> runs(sweep.runs.size());
  for (std::size_t k = 0; k < runs.size(); ++k)
    if (sweep.runs[k].state == RunState::finished || sweep.runs[k].state == RunState::failed) try {
        runs[k] = read_run(sweep.folder / sweep.runs[k].name, sweep.runs[k].name);
      } catch (const std::exception&) {  // it failed before its first row
      }
  std::vector<std::pair<std::string, std::string>> columns;  // names and headers
  for (const auto& run : runs)
    for (std::size_t c = 0; run && c < run->history.names.size(); ++c) {
      const std::string &name = run->history.names[c], &unit = run->history.units[c];
      if (name == "step" || name == "dt") continue;
      const std::pair column{name, unit == "1" ? name : name + " [" + unit + "]"};
      if (std::find(columns.begin(), columns.end(), column) == columns.end()) columns.push_back(column);
    }
  for (const auto& [label, path] : of_record) cells.header.emplace_back(label);
  for (const auto& [name, header] : columns) cells.header.push_back(header);
  for (std::size_t k = 0; k < runs.size(); ++k) {
    std::vector<std::string>& row = cells.rows[k];
    row.assign(cells.header.size(), "");
    if (!runs[k]) continue;
    std::size_t i = 0;
    for (const auto& [label, path] : of_record) {
      const Json::json_pointer pointer(path);
      if (runs[k]->record.is_object() && runs[k]->record.contains(pointer))
        row[i] = fmt::format("{:.10g}", runs[k]->record[pointer].get<double>());
      ++i;
    }
    for (const auto& [name, header] : columns) {
      const int c = runs[k]->history.column(name);
      if (c >= 0) row[i] = fmt::format("{:.10g}", runs[k]->history.rows.back()[std::size_t(c)]);
      ++i;
    }
  }
  return cells;
}

Json in_json(const Sweep& sweep) {
  Json settings = Json::object(), runs = Json::array();
  for (const OverrideSeries& s : sweep.series)
    for (const Override& o : s.overrides) settings[s.key].push_back(o.value);
  for (const SweepRun& run : sweep.runs) {
    Json of_run = Json::object();
    for (const auto& [key, value] : run.settings) of_run[key] = in_words(value);
    runs.push_back({{"name", run.name},
                    {"settings", of_run},
                    {"hash", run.hash()},
                    {"outcome", run_state_names[int(run.state)]},
                    {"failure", run.failure}});
  }
  return {{"talus", version()},
          {"case_file", sweep.case_file},
          {"case", sweep.case_text},
          {"values_in_toml", settings},
          {"runs", runs}};
}

}  // namespace

std::string SweepRun::hash() const {
  std::uint64_t hash = 0xcbf29ce484222325;  // FNV-1a
  for (char c : text) hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
  return fmt::format("{:016x}", hash);
}

Sweep plan_sweep(const std::string& case_file, const std::vector<OverrideSeries>& series, const fs::path& folder) {
  read_case(case_file);  // throws its complaints
  const std::string text = contents_of(case_file), beside = fs::path(case_file).parent_path().string();
  return plan(case_file, with_absolute_paths(case_file, text, beside), series, folder);
}

Sweep read_sweep(const fs::path& folder) {
  if (!fs::exists(folder / "sweep.json"))
    throw InputError(fmt::format("{} holds no sweep: there is no sweep.json", folder.string()));
  try {
    const Json sweep = Json::parse(contents_of(folder / "sweep.json"));
    std::vector<OverrideSeries> series;
    for (const auto& [key, values] : sweep.at("values_in_toml").items()) {
      series.push_back({key, {}});
      for (const Json& value : values)
        series.back().overrides.push_back(read_override(key + "=" + value.get<std::string>()));
    }
    return plan(sweep.at("case_file"), sweep.at("case"), std::move(series), folder);
  } catch (const Json::exception& e) {
    throw InputError(fmt::format("{}/sweep.json cannot be read: {}", folder.string(), e.what()));
  }
}

void find_results(Sweep& sweep) {
  for (SweepRun& run : sweep.runs) {
    const fs::path folder = sweep.folder / run.name;
    if (!fs::exists(folder / "case.toml")) continue;
    if (contents_of(folder / "case.toml") != run.text)
      throw InputError(fmt::format("{} holds the run of another case; give another folder with --out, or --overwrite",
                                   folder.string()));
    if (!fs::exists(folder / "record.json")) continue;
    const Json record = Json::parse(contents_of(folder / "record.json"), nullptr, false);
    if (!record.is_object() || !record.contains("run")) continue;
    const std::string outcome = record["run"].value("outcome", "");
    if (outcome == "finished") run.state = RunState::finished;
    if (outcome == "stopped") run.state = RunState::stopped;
    if (outcome == "failed") {
      run.state = RunState::failed;
      run.failure = record["run"].value("failure", "");
    }
  }
}

void write_sweep(const Sweep& sweep) { write_whole(sweep.folder / "sweep.json", in_json(sweep).dump(2) + "\n"); }

void write_sweep_table(const Sweep& sweep) {
  const Cells settings = settings_in_cells(sweep), results = results_in_cells(sweep);
  std::string text = "run";
  for (const Cells* cells : {&settings, &results}) {
    for (const std::string& column : cells->header) text += "," + quoted_for_csv(column);
    if (cells == &settings) text += ",outcome";
  }
  text += ",failure,hash\n";
  for (std::size_t k = 0; k < sweep.runs.size(); ++k) {
    const SweepRun& run = sweep.runs[k];
    text += run.name;
    for (const std::string& cell : settings.rows[k]) text += "," + quoted_for_csv(cell);
    text += std::string(",") + run_state_names[int(run.state)];
    for (const std::string& cell : results.rows[k]) text += "," + cell;
    text += "," + quoted_for_csv(run.failure.substr(0, run.failure.find('\n'))) + "," + run.hash() + "\n";
  }
  write_whole(sweep.folder / "table.csv", text);
}

void write_sweep_page(const Sweep& sweep) {
  const Cells settings = settings_in_cells(sweep);
  constexpr std::pair<const char*, const char*> results[] = {{"front_radius", "radius of the deposit"},
                                                             {"front_x_min", "left front"},
                                                             {"front_x_max", "right front"},
                                                             {"height", "height"},
                                                             {"kinetic_energy", "kinetic energy"}};
  std::vector<ComparedRun> runs;
  for (const SweepRun& run : sweep.runs)
    if (fs::exists(sweep.folder / run.name / "history.csv") && run.state != RunState::waiting) try {
        runs.push_back(read_run(sweep.folder / run.name, run.name));
      } catch (const std::exception&) {  // no row yet
      }
  std::string rows;
  for (std::size_t k = 0; k < sweep.runs.size(); ++k) {
    const SweepRun& run = sweep.runs[k];
    const auto read = std::find_if(runs.begin(), runs.end(), [&](const auto& r) { return r.name == run.name; });
    const bool has_report = fs::exists(sweep.folder / run.name / "report.html");
    rows +=
        "<tr><td>" + (has_report ? fmt::format("<a href=\"{0}/report.html\">{0}</a>", run.name) : run.name) + "</td>";
    for (const std::string& cell : settings.rows[k]) rows += "<td class=\"n\">" + escaped(cell) + "</td>";
    rows += fmt::format("<td>{}</td>", run_state_names[int(run.state)]);
    for (const auto& [name, label] : results) {
      const int c = read == runs.end() ? -1 : read->history.column(name);
      if (std::none_of(runs.begin(), runs.end(),
                       [&wanted = name](const auto& r) { return r.history.column(wanted) >= 0; }))
        continue;
      rows +=
          c < 0 ? "<td></td>" : fmt::format("<td class=\"n\">{:.4g}</td>", read->history.rows.back()[std::size_t(c)]);
    }
    rows += "</tr>\n";
    if (!run.failure.empty())
      rows += fmt::format("<tr class=\"d\"><td colspan=\"9\">{}</td></tr>\n", escaped(run.failure));
  }
  std::string head = "<tr><th>run</th>";
  for (const std::string& key : settings.header) head += "<th>" + escaped(key) + "</th>";
  head += "<th>outcome</th>";
  for (const auto& [name, label] : results)
    for (const ComparedRun& run : runs)
      if (const int c = run.history.column(name); c >= 0) {
        head += fmt::format("<th>{} [{}]</th>", label, run.history.units[std::size_t(c)]);
        break;
      }
  const std::string charts = runs.empty() ? "" : comparison_charts(runs);
  write_whole(
      sweep.folder / "sweep.html",
      page_head("Sweep of " + fs::path(sweep.case_file).stem().string()) +
          fmt::format("<h1>Sweep of {}</h1>\n<p>{} runs by talus {}. All results: <code>table.csv</code>.</p>\n",
                      escaped(fs::path(sweep.case_file).stem().string()), sweep.runs.size(), escaped(version())) +
          "<h2>Results at the end of each run</h2>\n<table>" + head + "</tr>\n" + rows + "</table>\n" +
          (charts.empty() ? "" : "<h2>Charts</h2>\n" + charts) + "</body></html>\n");
}

}  // namespace talus
