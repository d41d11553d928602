#include "talus/output/report.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <sstream>

#include "talus/base/file.hpp"
#include "talus/base/machine.hpp"
#include "talus/base/units.hpp"
#include "talus/output/page.hpp"
#include "talus/output/page_parts.hpp"
#include "talus/output/snapshot.hpp"
#include "talus/output/viewer.hpp"

namespace talus {

namespace {

constexpr double most_missed = 0.01;  ///< share of the energy turned over up to which a ledger counts as closed

/// A share of the energy turned over, as a percentage; a dash where nothing moved.
std::string share(double part, const Ledger& l) {
  return l.turnover > 0 ? fmt::format("{:.2f} %", 100 * part / l.turnover) : "&ndash;";
}

/// Does the energy ledger close? Its limit is that of the warning.
std::string verdict_of(const Ledger& l) {
  if (!(l.turnover > 0)) return "Nothing moved, so there is no energy to account for.";
  const double missed = std::abs(l.error()) / l.turnover;
  return fmt::format(
      "The ledger {}: {:.2g} % of the energy turned over is not accounted for (it closes up to {:.0f} %).",
      missed <= most_missed ? "closes" : "does not close", 100 * missed, 100 * most_missed);
}

std::string surface_in_words(const Wall& surface) {
  switch (surface.kind) {
    case WallKind::friction:
      return fmt::format("friction {:.3g}{}", surface.friction, surface.separates ? "" : " and held");
    case WallKind::symmetry: return "plane of symmetry";
    case WallKind::no_slip: return "sticking";
    case WallKind::periodic: return "periodic";
    case WallKind::outflow: return "outflow";
    default: return surface.separates ? "smooth, lets go" : "smooth";
  }
}

/// The case in a few sentences.
std::string in_words(const Case& what) {
  const auto length = [](double x) { return with_unit(x, "m"); };
  const auto size = [&](const Box& box) {
    std::vector<std::string> sides;
    for (int a = 0; a < what.dim; ++a) sides.push_back(length(box.max[a] - box.min[a]));
    return fmt::format("{}", fmt::join(sides, " x "));
  };
  std::string text = fmt::format("{}, domain {}, cells {}, gravity {}.",
                                 what.axisymmetric ? "Axisymmetric (x is the radius; y upwards)"
                                 : what.dim == 2   ? "Plane strain (x and y; y upwards)"
                                                   : "Three dimensions (z upwards)",
                                 size(what.domain), length(what.cell),
                                 with_unit(std::hypot(what.gravity[0], what.gravity[1], what.gravity[2]), "m/s2"));
  for (const BodySpec& body : what.bodies) {
    const Material& material = what.materials[body.material];
    const char* shape = std::holds_alternative<Cylinder>(body.region)    ? "cylinder"
                        : std::holds_alternative<Polygon>(body.region)   ? "polygon"
                        : std::holds_alternative<Raster>(body.region)    ? "picture"
                        : std::holds_alternative<PointList>(body.region) ? "list of points"
                                                                         : "box";
    const std::string apart = body.spacing > 0 ? fmt::format(", with particles {} apart", length(body.spacing)) : "";
    text += fmt::format(" `{}` is a {} within {}, of {} (law {}){}.", body.name, shape,
                        size(bounding_box(body.region, what.dim)), material.name,
                        std::visit([](const auto& law) { return std::string(law.name); }, material.law), apart);
  }
  for (const SurfaceLoad& load : what.loads) {
    std::vector<std::string> stresses;
    for (int a = 0; a < what.dim; ++a) stresses.push_back(with_unit(load.traction[a], "Pa"));
    text += fmt::format(" On side {} of `{}` acts ({}){}{}.", side_choices[load.side].word, what.bodies[load.body].name,
                        fmt::join(stresses, ", "), load.within ? ", on a part of it" : "",
                        load.factor.empty() ? "" : ", which changes in time");
  }
  std::vector<std::string> walls;
  for (int side = 0; side < 2 * what.dim; ++side)
    if (what.walls[side].kind != WallKind::open)
      walls.push_back(
          fmt::format("{}_{} {}", "xyz"[side / 2], side % 2 == 0 ? "min" : "max", surface_in_words(what.walls[side])));
  text += walls.empty() ? " There are no walls." : fmt::format(" Walls: {}.", fmt::join(walls, ", "));
  for (const Solid& solid : what.solids)
    text += fmt::format(" `{}` is a {}, {}, that {}.", solid.name, solid.hollow ? "hollow solid" : "solid",
                        surface_in_words(solid.contact),
                        solid.motion.rests()         ? "rests"
                        : solid.motion.angle.empty() ? "moves"
                                                     : "turns");
  return text + fmt::format(" It is followed until {}.", with_unit(what.end, "s"));
}

/// The viewer; and what stands in its place where a browser cannot show it.
std::string particles_section(const std::filesystem::path& folder, const Case& what, const RunSummary& run) {
  std::string section =
      "<noscript><p>This browser runs no scripts; the pictures below show the particles.</p></noscript>\n"
      "<p id=\"without\" hidden>This browser shows no WebGL, which the turning picture of the particles needs; the "
      "pictures below show them at some instants.</p>\n";
  try {
    std::vector<std::filesystem::path> snapshots = read_series(folder / "particles.hdf.series");
    if (!run.failure.empty()) snapshots.push_back(folder / "failure.hdf");
    return section + viewer(what, snapshots);
  } catch (const std::exception& e) {  // a report without particles is better than none
    return section + "<div class=\"warning\">" + escaped(e.what()) + "</div>\n";
  }
}

/// Rows of a history as they stand in the page: all, or the first of every `every` and the last where they would make it
/// large.
struct Rows {
  std::string text;
  std::size_t every;
};
Rows rows_of(const std::filesystem::path& csv) {
  constexpr std::size_t most_rows = 10000;
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
  nlohmann::json told = nlohmann::json::array();
  for (const Chart& chart : charts) {
    nlohmann::json curves = nlohmann::json::array();
    for (std::size_t i = 0; i < chart.curves.size(); ++i)
      curves.push_back(
          {{"column", chart.curves[i].column}, {"label", chart.curves[i].label}, {"colour", line_colour(int(i))}});
    told.push_back({{"name", chart.name},
                    {"x_label", chart.x_label},
                    {"y_label", chart.y_label},
                    {"x_scale", chart.x_scale},
                    {"y_scale", chart.y_scale},
                    {"x_column", chart.x_column},
                    {"curves", curves}});
    section += fmt::format(
        "<figure><div class=\"chart\" id=\"chart-{0}\"></div><div class=\"chart-legend\" id=\"legend-{0}\"></div>"
        "<figcaption>{1}</figcaption></figure>\n",
        chart.name, escaped(chart.caption));
    const std::filesystem::path drawn = folder / "pictures" / (chart.name + ".svg");
    if (std::filesystem::exists(drawn))
      section += "<noscript>" + embedded_figure(drawn, chart.caption) + "</noscript>\n";
  }
  const Rows rows = rows_of(folder / "history.csv");
  section += "</div>\n";
  if (rows.every > 1)
    section += fmt::format("<p class=\"note\">The curves go through every {}th row of history.csv.</p>\n", rows.every);
  return section + "<script type=\"text/csv\" id=\"history\">" + rows.text + "</script>\n" +
         embedded_json("charts", told.dump()) + embedded_script(page_parts::dygraph_js()) +
         embedded_script(page_parts::curves_js());
}

}  // namespace

std::string notice_of_stiffness(const Numerics& numerics) {
  const double factor = numerics.stiffness_factor;
  if (factor == 1) return "";
  return fmt::format(
      "The elastic stiffness is scaled by {:.4g} (`stiffness_factor`): steps that waves bound are about {:.2g} times "
      "longer; waves travel {:.2g} times slower, and the ground settles elastically {:.3g} times as much. Compare one "
      "run with 1.",
      factor, 1 / std::sqrt(factor), 1 / std::sqrt(factor), 1 / factor);
}

std::string notice_of_preset(const Case& what) {
  const Numerics& n = what.numerics;
  if (n.preset != Preset::paper) return "";
  std::vector<std::string> departures;
  const auto note = [&](bool departs, const std::string& text) {
    if (departs) departures.push_back(text);
  };
  note(n.shape_function != ShapeFunction::linear, "other shapes");
  note(n.transfer != Transfer::flip || n.flip_share != 1, "another transfer");
  note(n.order != Order::usf, "another order");
  note(n.integration.scheme != Integrator::forward_euler, "another integrator");
  note(n.average_pressure || n.f_bar, "averaging over cells");
  note(n.particle_shifting, "particle shifting");
  note(n.dt != 1e-6, fmt::format("dt = {:.4g} s", n.dt.value_or(0)));
  for (const Material& m : what.materials)
    std::visit(
        [&]<class Law>(const Law& law) {
          if constexpr (requires { law.collisional.form; })
            note(law.collisional.form != CollisionalForm::rate, "another collisional form of " + m.name);
          else if constexpr (requires { law.form; })
            note(law.form != CollisionalForm::rate, "another collisional form of " + m.name);
        },
        m.law);
  std::string text =
      "preset = \"paper\" is the paper's scheme as printed, for comparison: pressure scatters from particle to "
      "particle, the rate form leaves collisional stress behind at rest, and stress jumps where particles cross cells "
      "(docs/numerics.md).";
  if (!departures.empty()) text += fmt::format(" This case departs from it: {}.", fmt::join(departures, ", "));
  return text;
}

std::string notice_of_symmetry(const Case& what) {
  int planes = 0;
  for (const Wall& wall : what.walls) planes += wall.kind == WallKind::symmetry;
  if (planes == 0) return "";
  return fmt::format("{} plane{} of symmetry: masses, energies and impulses are those of the part that is computed.",
                     planes, planes == 1 ? "" : "s");
}

std::string notice_of_outflow(const Ledger& l) {
  if (l.outflow.mass == 0) return "";
  return fmt::format(
      "{:.3g} kg, {:.3g} % of the mass, have left through `outflow` sides. Fronts and heights are those of what is "
      "still there.",
      l.outflow.mass, 100 * l.outflow.mass / (l.outflow.mass + l.mass));
}

std::string in_words(const StepTally& t) {
  const auto length = [](double seconds) { return fmt::format("{:.3g} us", 1e6 * seconds); };
  if (t.n() == 0) return "no steps";
  std::string text = fmt::format("{} steps of {} to {}, {} on average; bound by", t.n(), length(t.shortest),
                                 length(t.longest), length(t.mean()));
  std::string separator = " ";
  for (int i = 0; i < n_bounds; ++i) {
    if (t.held[i] == 0) continue;
    std::string name(bound_names[i].word);
    std::replace(name.begin(), name.end(), '_', ' ');
    text += fmt::format("{}{} {:.1f} %", separator, name, 100 * t.share(Bound(i)));
    separator = ", ";
    if (Bound(i) == Bound::waves_and_motion)
      text += fmt::format(" (waves at {:.3g} m/s make {:.0f} % of it, particles at {:.2g} m/s the rest)",
                          t.mean_of(t.wave_speed), 100 * t.mean_of(t.wave_share), t.mean_of(t.speed));
  }
  return text;
}

std::vector<std::string> warnings_of(const Case& what, const RunSummary& run) {
  std::vector<std::string> warnings;
  if (const std::string notice = notice_of_stiffness(what.numerics); !notice.empty()) warnings.push_back(notice);
  if (const std::string notice = notice_of_preset(what); !notice.empty()) warnings.push_back(notice);
  const Ledger& l = run.ledger;
  // Shares of next to nothing say nothing: ground that was not lowered by a hundredth of a cell, on average, has rested.
  const double weight = l.mass * std::hypot(what.gravity[0], what.gravity[1], what.gravity[2]);
  const double energy = l.turnover > 0.01 * what.cell * weight ? l.turnover : 0;
  if (depends_on_step(what.numerics))
    warnings.push_back(fmt::format(
        "The result depends on the time step by construction: {} drops a share of the particles' velocity every step, "
        "however short it is. Use transfer = \"affine_tau\", or compare runs with different `cfl`.",
        what.numerics.transfer == Transfer::flip ? fmt::format("`flip_share` = {:.4g}", what.numerics.flip_share)
                                                 : fmt::format("transfer = \"{}\"", word_of(what.numerics.transfer))));
  if (energy > 0 && std::abs(l.error()) > most_missed * energy)
    warnings.push_back(
        fmt::format("The energy ledger misses {:.1f} % of the energy turned over: a smaller `cfl` helps.",
                    100 * std::abs(l.error()) / energy));
  if (energy > 0 && l.numerical + l.averaging > 0.25 * energy)
    warnings.push_back(fmt::format(
        "Numerical dissipation took {:.0f} % of the energy turned over: finer cells or a longer `tau` lower it.",
        100 * (l.numerical + l.averaging) / energy));
  if (energy > 0 && l.numerical + l.averaging < -most_missed * energy)
    warnings.push_back(fmt::format(
        "The method won {:.1f} % of the energy turned over: velocity that the grid cannot hold feeds on itself. "
        "Use {}a smoother `shape`.",
        -100 * (l.numerical + l.averaging) / energy,
        what.numerics.transfer == Transfer::affine_tau ? "" : "transfer = \"affine_tau\" or "));
  if (l.n_unconverged > 0)
    warnings.push_back(
        fmt::format("{} stress updates did not converge: a smaller `cfl` helps, or integrator = \"modified_euler\".",
                    l.n_unconverged));
  const bool moves = l.kinetic > 0.01 * l.turnover;  // and grains that fly are apart, as they should be
  if (!moves && l.n_separated > 0.2 * double(run.n_particles))
    warnings.push_back(fmt::format("{:.0f} % of the particles are separated at the end: more particles a cell help.",
                                   100.0 * l.n_separated / double(run.n_particles)));
  if (energy > 0 && l.plastic > 0 && moves)
    warnings.push_back("The material still moves at the end: a later `end` shows the deposit.");
  return warnings;
}

void write_record(const std::filesystem::path& file, const RunSummary& run) {
  nlohmann::ordered_json record;
  record["talus"] = version();
  record["build"] = build();
  record["case_file"] = run.case_file;
  for (const Understood& u : run.understood)
    record["case"][u.path] = {{"value", u.value}, {"default", u.by_default}, {"meaning", u.meaning}};
  record["machine"] = {{"processor", processor()}, {"processors", n_processors()}, {"threads", run.n_threads}};
  const Ledger& l = run.ledger;
  record["run"] = {{"outcome", !run.failure.empty() ? "failed"
                               : run.stopped        ? "stopped"
                                                    : "finished"},
                   {"failure", run.failure},
                   {"particles", run.n_particles},
                   {"steps", l.step},
                   {"simulated_seconds", l.time},
                   {"wall_seconds", run.wall_seconds},
                   {"cpu_seconds", run.cpu_seconds},
                   {"particle_steps_per_wall_second",
                    run.wall_seconds > 0 ? double(run.n_particles) * double(l.step) / run.wall_seconds : 0},
                   {"particle_steps_per_cpu_second",
                    run.cpu_seconds > 0 ? double(run.n_particles) * double(l.step) / run.cpu_seconds : 0},
                   {"bytes_per_particle", run.n_particles > 0 ? double(run.bytes) / double(run.n_particles) : 0},
                   {"snapshots", run.n_snapshots},
                   {"resumed_at_seconds", run.resumed_at},
                   {"warnings", run.warnings}};
  record["ledger_joule"] = {
      {"initial", l.initial},          {"kinetic", l.kinetic},     {"potential", l.potential},
      {"elastic", l.elastic},          {"plastic", l.plastic},     {"collisional", l.collisional},
      {"averaging", l.averaging},      {"numerical", l.numerical}, {"wall_friction", l.wall_friction},
      {"work_on_solids", l.wall_work}, {"turnover", l.turnover},   {"error", l.error()}};
  if (l.load_impulse != Vec<3>{}) {
    record["ledger_joule"]["work_of_loads"] = l.load_work;
    record["load_impulse_newton_second"] = {l.load_impulse[0], l.load_impulse[1], l.load_impulse[2]};
  }
  if (l.outflow.mass > 0)
    record["outflow"] = {
        {"mass_kilogram", l.outflow.mass},
        {"momentum_newton_second", {l.outflow.momentum[0], l.outflow.momentum[1], l.outflow.momentum[2]}},
        {"kinetic_joule", l.outflow.kinetic},
        {"potential_joule", l.outflow.potential},
        {"elastic_joule", l.outflow.elastic}};
  record["wall_impulse_newton_second"] = {l.wall_impulse[0], l.wall_impulse[1], l.wall_impulse[2]};
  const StepTally& t = run.tally;
  nlohmann::ordered_json held;
  for (int i = 0; i < n_bounds; ++i) held[std::string(bound_names[i].word)] = t.held[i];
  record["time_step"] = {{"shortest_seconds", t.n() > 0 ? t.shortest : 0},
                         {"mean_seconds", t.mean()},
                         {"longest_seconds", t.longest},
                         {"steps_bound_by", held},
                         {"of_waves_and_motion",
                          {{"mean_wave_speed", t.mean_of(t.wave_speed)},
                           {"mean_fastest_particle", t.mean_of(t.speed)},
                           {"share_of_waves", t.mean_of(t.wave_share)}}}};
  const auto outline = [](const Outline& o) {
    return nlohmann::ordered_json{{"front_x_min", o.front_min[0]},
                                  {"front_x_max", o.front_max[0]},
                                  {"front_radius", o.front_radius},
                                  {"farthest_x_min", o.farthest_min[0]},
                                  {"farthest_x_max", o.farthest_max[0]},
                                  {"farthest_radius", o.farthest_radius},
                                  {"height", o.height},
                                  {"height_at_axis", o.height_at_axis}};
  };
  record["outline_metre"] = {{"start", outline(run.start)}, {"end", outline(run.end)}};
  write_whole(file, record.dump(2) + "\n");
}

bool is_finished(const std::filesystem::path& folder, const std::string& case_text) {
  for (const char* name : {"record.json", "case.toml", "history.csv", "surface.csv"})
    if (!std::filesystem::exists(folder / name)) return false;
  const auto record = nlohmann::json::parse(contents_of(folder / "record.json"), nullptr, false);
  return record.is_object() && record.value("talus", "") == version() &&
         same_bits(record.value("build", ""), build()) && record.contains("run") &&
         record["run"].value("outcome", "") == "finished" && contents_of(folder / "case.toml") == case_text;
}

void write_report(const std::filesystem::path& folder, const Case& what, const RunSummary& run,
                  const std::vector<Picture>& pictures, const std::vector<Chart>& charts) {
  const Ledger& l = run.ledger;
  std::ostringstream page;
  page << page_head(what.title, std::string(page_parts::dygraph_css()) + std::string(page_parts::report_css()))
       << page_parts::licences_html() << "<h1>" << escaped(what.title) << "</h1>\n<p>"
       << escaped(fmt::format("talus {} \u2013 {} particles, {} steps, {:.4g} s simulated in {:.1f} s on {} thread{}.",
                              version(), run.n_particles, l.step, l.time, run.wall_seconds, run.n_threads,
                              run.n_threads == 1 ? "" : "s"))
       << "</p>\n";
  if (!run.failure.empty())
    page << "<div class=\"warning\"><b>The run failed.</b><pre>" << escaped(run.failure) << "</pre></div>\n";
  for (const std::string& w : run.warnings) page << "<div class=\"warning\">" << escaped(w) << "</div>\n";
  if (run.failure.empty() && run.warnings.empty())
    page << "<div class=\"warning good\">The run ended as it should: the ledger closes, and nothing calls for a "
            "warning.</div>\n";
  page << "<p>" << escaped(in_words(what)) << "</p>\n";

  page << "<h2>Particles</h2>\n" << particles_section(folder, what, run);
  page << "<h2>In time</h2>\n<p>Point at a curve to read it off; drag over it to enlarge a part, double-click to see "
          "all "
          "again. A click shows the particles at that instant.</p>\n"
       << charts_section(folder, charts);

  if (const std::string notice = notice_of_symmetry(what); !notice.empty())
    page << "<p>" << escaped(notice) << "</p>\n";
  if (const std::string notice = notice_of_outflow(l); !notice.empty()) page << "<p>" << escaped(notice) << "</p>\n";

  const LengthUnit unit = length_unit_for(extent(what));
  const auto length = [&](double x) {
    return fmt::format("{:.{}f} {}", x / unit.length, unit.length < 1 ? 1 : 3, unit.name);
  };
  page << "<h2>Outline</h2>\n<table><tr><th></th><th>start</th><th>end</th></tr>\n";
  const auto row = [&](const char* name, double a, double b) {
    page << fmt::format("<tr><td>{}</td><td class=\"n\">{}</td><td class=\"n\">{}</td></tr>\n", name, length(a),
                        length(b));
  };
  if (!what.axisymmetric) {
    row("left front, x", run.start.front_min[0], run.end.front_min[0]);
    row("right front, x", run.start.front_max[0], run.end.front_max[0]);
  }
  if (what.dim == 3 || what.axisymmetric) row("radius", run.start.front_radius, run.end.front_radius);
  row("height", run.start.height, run.end.height);
  row("height at the axis", run.start.height_at_axis, run.end.height_at_axis);
  page << "</table>\n";

  if (!pictures.empty()) {
    page << "<h2>Pictures</h2>\n";
    for (const Picture& p : pictures) page << embedded_figure(p.file, p.caption);
  }
  page << "<h2>Energy</h2>\n<p><b>" << escaped(verdict_of(l)) << "</b></p>\n<p>Of "
       << fmt::format("{:.4g} J", l.turnover)
       << (what.axisymmetric ? " per radian"
           : what.dim == 2   ? " per metre of thickness"
                             : "")
       << " that were turned over:</p>\n<table>\n";
  const auto energy = [&](const char* name, double joule) {
    page << fmt::format("<tr><td>{}</td><td class=\"n\">{:.4g} J</td><td class=\"n\">{}</td></tr>\n", name, joule,
                        share(joule, l));
  };
  energy("is still kinetic", l.kinetic);
  energy("is stored elastically", l.elastic);
  energy("became heat by friction", l.plastic);
  energy("was spent in collisions", l.collisional);
  energy("was lost when compression was averaged over cells", l.averaging);
  energy("was lost in the transfers between particles and grid", l.numerical);
  energy("became heat by friction on walls and solids", l.wall_friction);
  energy("was work on moving solids (negative: they pushed)", l.wall_work);
  if (!what.loads.empty()) energy("was put in by loads on sides of bodies", l.load_work);
  if (has_outflow(what)) energy("left as kinetic energy of what flowed out", l.outflow.kinetic);
  energy("is not accounted for", -l.error());
  page << "</table>\n";

  page << "<h2>Time step</h2>\n<p>" << escaped(in_words(run.tally)) << ".</p>\n<table>\n";
  for (int i = 0; i < n_bounds; ++i)
    if (run.tally.held[i] > 0)
      page << fmt::format("<tr><td>{}</td><td class=\"n\">{} steps</td><td class=\"n\">{:.2f} %</td></tr>\n",
                          bound_names[i].meaning, run.tally.held[i], 100 * run.tally.share(Bound(i)));
  page << "</table>\n";

  page << "<h2>The case as it was understood</h2>\n<p>Grey: defaults.</p>\n<table>\n";
  for (const Understood& u : run.understood)
    page << fmt::format("<tr{}><td><code>{}</code></td><td>{}</td><td>{}</td></tr>\n",
                        u.by_default ? " class=\"d\"" : "", escaped(u.path), escaped(u.value), escaped(u.meaning));
  page << "</table>\n<h2>The case file</h2>\n<p><code>" << escaped(run.case_file) << "</code></p>\n<pre>"
       << escaped(run.case_text) << "</pre>\n";
  page << "<h2>Record</h2>\n<table>\n";
  const auto fact = [&](const char* name, const std::string& value) {
    page << fmt::format("<tr><td>{}</td><td>{}</td></tr>\n", name, escaped(value));
  };
  fact("version", version());
  fact("build", build());
  fact("processor", processor());
  fact("particle-steps per second",
       fmt::format("{:.3g} (wall), {:.3g} (per CPU-second)",
                   double(run.n_particles) * double(l.step) / std::max(run.wall_seconds, 1e-9),
                   double(run.n_particles) * double(l.step) / std::max(run.cpu_seconds, 1e-9)));
  fact("memory of particles and grid",
       fmt::format("{:.0f} bytes a particle", double(run.bytes) / double(std::max(1L, run.n_particles))));
  if (const std::size_t n = run.resumed_at.size(); n > 0)
    fact("stopped and gone on with",
         fmt::format("{} time{}, from t = {:.6g} s", n, n == 1 ? "" : "s", fmt::join(run.resumed_at, " s, ")));
  fact("snapshots", fmt::format("{}, listed in particles.hdf.series", run.n_snapshots));
  page << "</table>\n</body></html>\n";
  write_whole(folder / "report.html", page.str());
}

}  // namespace talus
