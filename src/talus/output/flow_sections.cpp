#include "talus/output/flow_sections.hpp"

#include <fmt/format.h>

#include <cmath>

#include "talus/output/map_picture.hpp"
#include "talus/output/page.hpp"

namespace talus {

namespace {

/// With three digits, or all those before the point.
std::string digits_of(double value) { return std::abs(value) < 100 ? fmt::format("{:.3g}", value) : grouped(value); }

}  // namespace

std::string thalweg_section(const std::optional<ThalwegRunout>& runout) {
  if (!runout) return "";
  const ThalwegRunout& r = *runout;
  std::string section = "<h2>Runout along the thalweg</h2>\n<table>\n";
  const auto row = [&](const char* name, const std::string& value) {
    section += fmt::format("<tr><td>{}</td><td class=\"n\">{}</td></tr>\n", name, value);
  };
  row("s of the upper end of the release", fmt::format("{} m", grouped(r.release)));
  row("s of the farthest flow: runout", fmt::format("{} m of {} m", grouped(r.runout), grouped(r.thalweg)));
  row("drop H between them, of the ground on the thalweg", fmt::format("{} m", grouped(r.drop())));
  row("length L between them, along the thalweg in plan", fmt::format("{} m", grouped(r.length)));
  if (r.length > 0) row("H/L and angle of reach", fmt::format("{:.3f}, {:.1f}\u00b0", r.ratio(), r.angle()));
  row("share of the area where flow has been, beside the strip", fmt::format("{:.1f} %", 100 * r.share_beside));
  return section +
         "</table>\n<p>s is the distance along the thalweg in plan from its higher end. Flow counts where it exceeds "
         "<code>output.maps.least_thickness</code> and lies no farther from the thalweg than half of "
         "<code>thalweg.width</code>. The curves along the thalweg are in <code>profile.csv</code>.</p>\n";
}

std::string gauges_section(const std::vector<GaugeSummary>& gauges) {
  if (gauges.empty()) return "";
  std::string section =
      "<h2>Gauges</h2>\n<table>\n<tr><th>gauge</th><th>east, north [m]</th><th>arrival [s]</th><th>largest thickness "
      "[m]</th><th>largest speed [m/s]</th><th>largest pressure [kPa]</th><th>largest flux [m\u00b3/s]</th><th>volume "
      "crossed [m\u00b3]</th></tr>\n";
  bool has_lines = false;
  for (const GaugeSummary& s : gauges) {
    const bool is_line = s.gauge.is_line();
    has_lines = has_lines || is_line;
    const auto place = [](const Vec<2>& x) { return fmt::format("{}, {}", grouped(x[0]), grouped(x[1])); };
    const auto cell = [&](const std::string& value) { section += "<td class=\"n\">" + value + "</td>"; };
    section += "<tr><td>" + escaped(s.gauge.name) + "</td>";
    cell(is_line ? place(s.gauge.points.front()) + " \u2013 " + place(s.gauge.points.back())
                 : place(s.gauge.points.front()));
    cell(s.arrival ? fmt::format("{:.4g}", *s.arrival) : "no flow");
    cell(fmt::format("{:.3g}", s.thickness));
    cell(s.arrival ? fmt::format("{:.3g}", s.speed) : "&ndash;");
    cell(s.arrival ? digits_of(1e-3 * s.pressure) : "&ndash;");
    cell(is_line ? digits_of(s.flux) : "");
    cell(is_line ? grouped(s.volume) : "");
    section += "</tr>\n";
  }
  section +=
      "</table>\n<p>Thickness is normal to the ground, pressure is rho v\u00b2. Arrival, speed and pressure are those "
      "of "
      "flow that exceeds <code>output.maps.least_thickness</code>.";
  if (has_lines)
    section +=
        " Flux and volume through a line are positive towards its left, looking from its first point to its last. "
        "Thickness, speed and pressure of a line are the largest along it.";
  return section + " Time histories are below and in <code>gauges.csv</code>.</p>\n";
}

}  // namespace talus
