#include "talus/output/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <numbers>
#include <sstream>

#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"
#include "talus/base/units.hpp"
#include "talus/output/case_in_words.hpp"
#include "talus/output/flow_sections.hpp"
#include "talus/output/map_picture.hpp"
#include "talus/output/map_view.hpp"
#include "talus/output/notices.hpp"
#include "talus/output/page.hpp"
#include "talus/output/page_parts.hpp"
#include "talus/output/snapshot.hpp"
#include "talus/output/surface_profiles.hpp"
#include "talus/output/viewer.hpp"

namespace talus {

namespace {

/// A share of the energy released, as a percentage; a dash if nothing moved.
std::string share(double part, const Ledger& l) {
  return l.turnover > 0 ? fmt::format("{:.2f} %", 100 * part / l.turnover) : "&ndash;";
}

/// Whether the energy balance is closed; the limit is that of the warning.
std::string verdict_of(const Ledger& l) {
  if (!(l.turnover > 0)) return "No energy was released: nothing moved.";
  const double missed = std::abs(l.error()) / l.turnover;
  return fmt::format("Energy balance {}: the error is {:.2g} % of the energy released (limit {:.0f} %).",
                     missed <= most_missed ? "closed" : "not closed", 100 * missed, 100 * most_missed);
}

/// The viewer, and a text in its place for browsers that cannot show it.
std::string particles_section(const std::filesystem::path& folder, const Case& case_, const RunSummary& run,
                              std::size_t budget) {
  std::string section =
      "<noscript><p>This browser runs no scripts. The pictures below show the particles.</p></noscript>\n"
      "<p id=\"without\" hidden>This browser has no WebGL, which the 3D view of the particles needs. The pictures "
      "below "
      "show them at some instants.</p>\n";
  try {
    std::vector<std::filesystem::path> snapshots = read_series(folder / "particles.hdf.series");
    if (!run.failure.empty()) snapshots.push_back(folder / "failure.hdf");
    return section + viewer(case_, snapshots, budget);
  } catch (const std::exception& e) {  // a report without particles is better than none
    return section + "<div class=\"warning\">" + escaped(e.what()) + "</div>\n";
  }
}

/// Bytes of a page with report = "small": of all, of its pictures, of its maps, and the least for its particles.
constexpr std::size_t most_bytes = 8'000'000, most_of_pictures = 2'500'000, most_of_maps = 2'500'000,
                      least_of_particles = 300'000;

/// Bytes that the packed particles of a page may take if the rest has so many.
std::size_t budget_of_particles(const Case& case_, std::size_t rest) {
  if (case_.output.report == ReportSize::full) return std::numeric_limits<std::size_t>::max();
  rest += page_parts::three_js().size() + page_parts::orbit_controls_js().size() + page_parts::viewer_js().size();
  return rest + least_of_particles < most_bytes ? most_bytes - rest : least_of_particles;
}

/// Pictures of a run, those that fit, evenly; a note states how many are left out.
std::string pictures_section(const Case& case_, const std::vector<Picture>& pictures) {
  std::string figures, note;
  std::size_t n = pictures.size();
  const auto embed = [&] {
    figures.clear();
    for (std::size_t i : spread_out(pictures.size(), n))
      figures += embedded_figure(pictures[i].file, pictures[i].caption);
  };
  embed();
  while (case_.output.report != ReportSize::full && n > 1 && figures.size() > most_of_pictures) {
    n = std::clamp<std::size_t>(n * most_of_pictures / figures.size(), 1, n - 1);
    embed();
  }
  if (n < pictures.size())
    note = fmt::format(
        "<p class=\"note\">The page shows {} of {} pictures, to limit its size; output.report = \"full\" shows all. "
        "All "
        "are in the folder {}.</p>\n",
        n, pictures.size(), escaped(pictures.front().file.parent_path().filename().string()));
  return figures + note;
}

/// Rows of a history for the page: all, or the first of every `every` and the last if all of them would make it large.
struct Rows {
  std::string text;
  std::size_t every;
};
Rows rows_of(const std::filesystem::path& csv) {
  constexpr std::size_t most_rows = 1000;  // more than a chart has pixels
  std::vector<std::string> lines;
  std::ifstream in(csv);
  for (std::string line; std::getline(in, line);) lines.push_back(line);
  const std::size_t every = lines.size() / most_rows + 1;
  std::string rows;
  for (std::size_t i = 0; i < lines.size(); ++i)
    if (i <= 1 || (i - 1) % every == 0 || i + 1 == lines.size()) rows += lines[i] + "\n";
  return {rows, every};
}

std::string charts_section(const std::filesystem::path& folder, const std::vector<Chart>& charts) {
  std::string section = "<div class=\"charts\">\n";
  nlohmann::json listed = nlohmann::json::array();
  for (const Chart& chart : charts) {
    nlohmann::json curves = nlohmann::json::array();
    for (std::size_t i = 0; i < chart.curves.size(); ++i)
      curves.push_back(
          {{"column", chart.curves[i].column}, {"label", chart.curves[i].label}, {"colour", line_colour(int(i))}});
    listed.push_back({{"name", chart.name},
                      {"x_label", chart.x_label},
                      {"y_label", chart.y_label},
                      {"x_scale", chart.x_scale},
                      {"y_scale", chart.y_scale},
                      {"x_column", chart.x_column},
                      {"rows", chart.csv.substr(0, chart.csv.find('.'))},
                      {"curves", curves}});
    section += fmt::format(
        "<figure><div class=\"chart\" id=\"chart-{0}\"></div><div class=\"chart-legend\" id=\"legend-{0}\"></div>"
        "<figcaption>{1}</figcaption></figure>\n",
        chart.name, escaped(chart.caption));
    const std::filesystem::path drawn = folder / "pictures" / (chart.name + ".svg");
    if (std::filesystem::exists(drawn))
      section += "<noscript>" + embedded_figure(drawn, chart.caption) + "</noscript>\n";
  }
  section += "</div>\n";
  for (const std::string& id : {std::string("history"), std::string("gauges")}) {
    const std::string csv = id + ".csv";
    if (id != "history" && std::ranges::count(charts, csv, &Chart::csv) == 0) continue;
    const Rows rows = rows_of(folder / csv);
    if (rows.every > 1)
      section += fmt::format("<p class=\"note\">The curves show every {}th row of {}.</p>\n", rows.every, csv);
    section += "<script type=\"text/csv\" id=\"" + id + "\">" + rows.text + "</script>\n";
  }
  return section + embedded_json("charts", listed.dump()) + embedded_script(page_parts::dygraph_js()) +
         embedded_script(page_parts::curves_js());
}

std::string title_section(const Case& case_, const RunSummary& run) {
  std::string section =
      "<h1>" + escaped(case_.title) + "</h1>\n<p>" +
      escaped(fmt::format("talus {} \u2013 {} particles, {} steps, {:.4g} s simulated in {:.1f} s on {} thread{}.",
                          version(), run.n_particles, run.ledger.step, run.ledger.time, run.wall_seconds, run.n_threads,
                          run.n_threads == 1 ? "" : "s")) +
      "</p>\n";
  if (!run.failure.empty())
    section += "<div class=\"warning\"><b>The run failed.</b><pre>" + escaped(run.failure) + "</pre></div>\n";
  for (const std::string& w : run.warnings) section += "<div class=\"warning\">" + escaped(w) + "</div>\n";
  if (run.failure.empty() && run.warnings.empty())
    section += "<div class=\"warning good\">Run completed. Energy balance closed; no warnings.</div>\n";
  return section + "<p>" + escaped(in_words(case_)) + "</p>\n";
}

/// Where material has left a run on terrain; nothing if none has.
std::string outflow_section(const RunSummary& run) {
  if (run.outflow.empty()) return "";
  const Ledger& l = run.ledger;
  std::string section = fmt::format(
      "<h3>Material that left the domain</h3>\n<p>{:.3g} kg, {:.3g} % of the mass. Runout and deposit are those of the "
      "material in the domain; gaps are ground without heights.</p>\n"
      "<table>\n<tr><th>where</th><th>mass</th><th>share</th><th>centre, east and north</th><th>length</th></tr>\n",
      l.outflow.mass, 100 * l.outflow.mass / (l.outflow.mass + l.mass));
  for (const OutflowOnMap& p : run.outflow)
    section += fmt::format(
        "<tr><td>{}</td><td class=\"n\">{:.4g} kg</td><td class=\"n\">{:.3g} %</td><td class=\"n\">{}, {} m</td>"
        "<td class=\"n\">{:.3g} m</td></tr>\n",
        p.name, p.mass, 100 * p.share, grouped(p.middle[0]), grouped(p.middle[1]), p.length());
  return section + "</table>\n";
}

/// What the maps say, and the maps.
std::string maps_section(const std::filesystem::path& folder, const Case& case_, const RunSummary& run,
                         const std::vector<Picture>& maps) {
  const Runout& r = *run.runout;
  std::string section = "<h2>Maps</h2>\n<table>\n";
  const auto row = [&](const char* name, const std::string& value) {
    section += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td></tr>\n", name, value);
  };
  row("released", fmt::format("{} m\u00b3", grouped(r.released)));
  row("of it in the domain at the end, as released", fmt::format("{} m\u00b3", grouped(r.at_start)));
  row("its volume at the end", fmt::format("{} m\u00b3", grouped(r.particles)));
  row("volume on the maps at the end", fmt::format("{} m\u00b3", grouped(r.deposited)));
  row("bulking factor: volume at the end over volume as released", fmt::format("{:.3f}", r.bulking()));
  row("area reached by the flow, in plan", fmt::format("{} m\u00b2", grouped(r.area)));
  row("drop from the highest point of the release to the farthest point reached",
      fmt::format("{} m", grouped(r.reach.drop)));
  row("distance between them, in plan", fmt::format("{} m", grouped(r.reach.length)));
  const auto ratio = [](const FlowReach& reach) {
    return fmt::format("{:.2f}, an angle of {:.1f}\u00b0", reach.drop / reach.length,
                       reach.angle() * 180 / std::numbers::pi);
  };
  const auto place = [](const FlowReach& reach) {
    return fmt::format("east {}, north {} m", grouped(reach.farthest[0]), grouped(reach.farthest[1]));
  };
  if (r.reach.length > 0) row("drop over distance", ratio(r.reach));
  row("farthest point reached", place(r.reach));
  if (r.connected_area < r.area && r.connected.length > 0) {
    row("area of the flow that is connected, without single particles ahead or beside",
        fmt::format("{} m\u00b2", grouped(r.connected_area)));
    row("farthest point of the connected flow", place(r.connected));
    row("drop and distance to it", fmt::format("{} m, {} m", grouped(r.connected.drop), grouped(r.connected.length)));
    row("drop over distance to it", ratio(r.connected));
  }
  row("largest thickness", fmt::format("{:.3g} m", r.thickness));
  row("largest speed", fmt::format("{:.3g} m/s", r.speed));
  section +=
      "</table>\n<p>Thickness is normal to the ground. Speed and arrival are given where material is thicker than "
      "the limit <code>output.maps.least_thickness</code>. Maps show the present volume of the material: it is larger "
      "than released where the material is loose, by 25 % at most. The rasters are in the folder "
      "<code>maps</code>.</p>\n";
  try {
    MapBudget budget;
    if (case_.output.report == ReportSize::full)
      budget.bytes = std::numeric_limits<std::size_t>::max();
    else
      budget = {3e5, 60, most_of_maps};
    section += map_view(folder / "maps", case_, run.case_text, budget);
  } catch (const std::exception& e) {  // a report without this map is better than none
    section += "<div class=\"warning\">" + escaped(e.what()) + "</div>\n";
  }
  section += outflow_section(run);
  section += "<div class=\"charts\">\n";
  return section + pictures_section(case_, maps) + "</div>\n";
}

std::string outline_section(const Case& case_, const Outline& start, const Outline& end) {
  const LengthUnit unit = length_unit_for(extent(case_));
  const auto length = [&](double x) {
    return fmt::format("{:.{}f} {}", x / unit.length, unit.length < 1 ? 1 : 3, unit.name);
  };
  std::string section = "<h2>Runout and height</h2>\n<table><tr><th></th><th>start</th><th>end</th></tr>\n";
  const auto row = [&](const char* name, double a, double b) {
    section +=
        fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n", name, length(a), length(b));
  };
  if (!case_.axisymmetric) {
    row("left front, x", start.front_min[0], end.front_min[0]);
    row("right front, x", start.front_max[0], end.front_max[0]);
  }
  if (case_.dim == 3 || case_.axisymmetric) row("radius", start.front_radius, end.front_radius);
  row("height", start.height, end.height);
  row("height at the axis", start.height_at_axis, end.height_at_axis);
  return section + "</table>\n";
}

/// Peaks of the forces on walls and solids.
std::string forces_section(const Case& case_, const SurfaceSummary& all) {
  if (all.surfaces.empty()) return "";
  std::string section = fmt::format(
      "<h2>Forces</h2>\n<p>Force of the material on walls and solids{}, as mean over {:.3g} s "
      "(<code>output.peak_force_time</code>).</p>\n<table><tr><th></th><th>peak</th><th>its normal part</th>"
      "<th>its tangential part</th><th>at</th><th>at the end</th></tr>\n",
      case_.axisymmetric ? ", per radian"
      : case_.dim == 2   ? ", per metre of thickness"
                         : "",
      all.averaged_over);
  for (const SurfaceSummary::OfSurface& s : all.surfaces) {
    section += "<tr><td>" + escaped(s.label) + "</td>";
    if (s.peak) {
      const double peak = length(s.peak->total);
      const auto newton = [&](double force) {  // 0 for what is left by rounding
        return fmt::format("<td class=\"n\">{:.4g} N</td>", force > 1e-9 * peak ? force : 0);
      };
      section += newton(peak) + newton(length(s.peak->normal)) + newton(length(s.peak->tangential())) +
                 fmt::format("<td class=\"n\">{:.4g} s</td>", s.peak->time) + newton(length(s.end->total));
    } else {
      section += "<td colspan=\"5\">the run is shorter than the averaging time</td>";
    }
    section += "</tr>\n";
  }
  return section + "</table>\n";
}

/// Where the heat of friction on walls and solids went, if there are several places, and what of it was turbulent.
std::vector<std::pair<std::string, double>> parts_of_friction(const SurfaceSummary& all) {
  std::vector<std::pair<std::string, double>> parts;
  for (const SurfaceSummary::OfSurface& s : all.surfaces)
    if (s.friction) parts.emplace_back("on " + escaped(s.label), *s.friction);
  for (const SurfaceSummary::OfZone& zone : all.zones) parts.emplace_back("in " + escaped(zone.label), zone.friction);
  if (parts.size() == 1) parts.clear();
  if (all.turbulent) parts.emplace_back("by turbulent friction", *all.turbulent);
  return parts;
}

std::string energy_section(const Case& case_, const Ledger& l, const SurfaceSummary& surfaces) {
  std::string section = "<h2>Energy</h2>\n<p><b>" + escaped(verdict_of(l)) + "</b></p>\n<p>Of " +
                        fmt::format("{:.4g} J", l.turnover) +
                        (case_.axisymmetric ? " per radian"
                         : case_.dim == 2   ? " per metre of thickness"
                                            : "") +
                        " of energy released:</p>\n<table>\n";
  const auto row = [&](const char* name, double joule) {
    section += fmt::format("<tr><td>{}</td><td class=\"n\">{:.4g} J</td><td class=\"n\">{}</td></tr>\n", name, joule,
                           share(joule, l));
  };
  row("kinetic energy at the end", l.kinetic);
  row("elastic energy at the end", l.elastic);
  row("frictional dissipation", l.plastic);
  row("collisional dissipation", l.collisional);
  row("dissipation by averaging of pressure over cells", l.averaging);
  row("dissipation by bulk viscosity", l.viscous);
  row("numerical dissipation in transfers between particles and grid", l.numerical);
  row("friction on walls and solids", l.wall_friction);
  for (const auto& [where, joule] : parts_of_friction(surfaces)) row(("&ensp;of which " + where).c_str(), joule);
  row("work on moving solids (negative: by the solids)", l.wall_work);
  if (!case_.loads.empty()) row("work of loads on sides of bodies", l.load_work);
  if (has_outflow(case_)) row("kinetic energy of material that left the domain", l.outflow.kinetic);
  row("balance error", -l.error());
  return section + "</table>\n";
}

std::string noise_section(const std::optional<NoiseShares>& noise) {
  if (!noise) return "";
  return fmt::format(
      "<h2>Pressure noise</h2>\n<p>Fluctuation of the pressure where material flows, as a share of its mean, in blocks "
      "of four cells along each "
      "axis:</p>\n<table>\n"
      "<tr><td>mean of a block, in time</td><td class=\"n\">{:.1f} %</td></tr>\n"
      "<tr><td>particles of a cell, about the mean of the cell</td><td class=\"n\">{:.1f} %</td></tr>\n</table>\n",
      100 * noise->in_time, 100 * noise->within_cells);
}

std::string time_step_section(const StepTally& tally) {
  std::string section = "<h2>Time step</h2>\n<p>" + escaped(in_words(tally)) + ".</p>\n<table>\n";
  for (int i = 0; i < n_bounds; ++i)
    if (tally.held[i] > 0)
      section += fmt::format("<tr><td>{}</td><td class=\"n\">{} steps</td><td class=\"n\">{:.2f} %</td></tr>\n",
                             bound_names[i].meaning, tally.held[i], 100 * tally.share(Bound(i)));
  return section + "</table>\n";
}

std::string case_section(const RunSummary& run) {
  std::string section = "<h2>Settings</h2>\n<p>The case as talus reads it; defaults in grey.</p>\n<table>\n";
  for (const Understood& u : run.understood)
    section += fmt::format("<tr{}><td><code>{}</code></td><td>{}</td><td>{}</td></tr>\n",
                           u.by_default ? " class=\"d\"" : "", escaped(u.path), escaped(u.value), escaped(u.meaning));
  return section + "</table>\n<h2>Case file</h2>\n<p><code>" + escaped(run.case_file) + "</code></p>\n<pre>" +
         escaped(run.case_text) + "</pre>\n";
}

std::string record_section(const RunSummary& run) {
  std::string section = "<h2>Record</h2>\n<table>\n";
  const auto fact = [&](const char* name, const std::string& value) {
    section += fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", name, escaped(value));
  };
  fact("version", version());
  fact("build", build());
  fact("processor", processor());
  fact("particle-steps per second",
       fmt::format("{:.3g} (wall), {:.3g} (per CPU-second)",
                   double(run.n_particles) * double(run.ledger.step) / std::max(run.wall_seconds, 1e-9),
                   double(run.n_particles) * double(run.ledger.step) / std::max(run.cpu_seconds, 1e-9)));
  fact("memory of particles and grid",
       fmt::format("{:.0f} bytes per particle", double(run.bytes) / double(std::max(1L, run.n_particles))));
  if (const Ledger& l = run.ledger; l.n_split + l.n_merged > 0)
    fact("particles", fmt::format("{} at the start, {} split, {} merged", run.n_particles, l.n_split, l.n_merged));
  if (const std::size_t n = run.resumed_at.size(); n > 0)
    fact("stopped and resumed",
         fmt::format("{} time{}, from t = {:.6g} s", n, n == 1 ? "" : "s", fmt::join(run.resumed_at, " s, ")));
  fact("snapshots", fmt::format("{}, listed in particles.hdf.series", run.n_snapshots));
  return section + "</table>\n";
}

}  // namespace

void write_report(const std::filesystem::path& folder, const Case& case_, const RunSummary& run,
                  const std::vector<Picture>& pictures, const std::vector<Chart>& charts) {
  std::ostringstream head, tail;
  head << page_head(case_.title, std::string(page_parts::dygraph_css()) + std::string(page_parts::report_css()))
       << page_parts::licences_html() << embedded_script(page_parts::player_js()) << title_section(case_, run);
  if (run.runout) head << maps_section(folder, case_, run, pictures);
  head << thalweg_section(run.thalweg) << gauges_section(run.gauges);
  head << "<h2>Particles</h2>\n";
  tail << "<h2>Time histories</h2>\n<p>Point at a curve to read its value, drag to enlarge a part, double-click to "
          "reset. A "
          "click shows the particles at that instant.</p>\n"
       << charts_section(folder, charts);
  for (const std::string& notice : {notice_of_symmetry(case_), run.outflow.empty() ? notice_of_outflow(run) : ""})
    if (!notice.empty()) tail << "<p>" << escaped(notice) << "</p>\n";
  if (!run.runout) {
    tail << outline_section(case_, run.start, run.end) << surface_profiles(profile_file(folder), extent(case_));
    if (!pictures.empty()) tail << "<h2>Pictures</h2>\n";
    tail << pictures_section(case_, pictures);
  }
  tail << forces_section(case_, run.surfaces) << energy_section(case_, run.ledger, run.surfaces)
       << noise_section(run.noise) << time_step_section(run.tally) << case_section(run) << record_section(run)
       << "</body></html>\n";
  const std::string before = head.str(), after = tail.str();
  write_whole(
      folder / "report.html",
      before + particles_section(folder, case_, run, budget_of_particles(case_, before.size() + after.size())) + after);
}

}  // namespace talus
