#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <optional>

#include "talus/base/units.hpp"
#include "talus/case/check.hpp"
#include "talus/case/keys.hpp"
#include "talus/geometry/plan_path.hpp"

namespace talus {

namespace {

/// In the coordinates of the map.
std::string on_map_of(const Case& case_, const Vec<2>& x) {
  const Vec<2> place = x + case_.map->frame.origin;
  return fmt::format("({:.10g}, {:.10g})", std::round(10 * place[0]) / 10, std::round(10 * place[1]) / 10);
}

/// Reason why points are invalid as a line or place; empty if valid.
std::string fault_of_points(const std::vector<Vec<2>>& points, const Case& case_) {
  if (!std::ranges::all_of(points, [](const Vec<2>& x) { return std::isfinite(x[0]) && std::isfinite(x[1]); }))
    return "has a coordinate that is not finite";
  if (points.size() > 1 && PlanPath(points).length() == 0)
    return fmt::format("has no length: it begins and ends at {}", on_map_of(case_, points[0]));
  const Terrain& ground = *case_.map->ground;
  const auto unknown = [&]() -> std::optional<Vec<2>> {
    if (points.size() == 1)
      return ground.is_known_up_to_edge(points[0][0], points[0][1]) ? std::nullopt : std::optional(points[0]);
    const PlanPath path(points);
    for (const Vec<2>& x : points)
      if (!ground.is_known_up_to_edge(x[0], x[1])) return x;
    const double step = ground.heights().pixel;
    for (double s = 0; s < path.length(); s += step)
      if (const Vec<2> x = path.at(s); !ground.is_known_up_to_edge(x[0], x[1])) return x;
    return std::nullopt;
  }();
  if (!unknown) return "";
  const PlanRaster& heights = ground.heights();
  if (heights.has_pixel(heights.column_of((*unknown)[0]), heights.row_of((*unknown)[1])))
    return fmt::format("lies where the terrain has no data, at {}", on_map_of(case_, *unknown));
  return fmt::format("lies outside the terrain at {}; the terrain reaches from {} to {}", on_map_of(case_, *unknown),
                     on_map_of(case_, heights.corner), on_map_of(case_, heights.far_corner()));
}

bool is_plain(const std::string& name) {
  return !name.empty() && std::ranges::all_of(name, [](char c) {
    return std::isalnum(static_cast<unsigned char>(c)) || c == '_' || c == '-';
  });
}

/// Distance between a thalweg and the releases [m]; none if no release is a layer.
std::optional<double> distance_from_release(const PlanPath& path, const Case& case_) {
  std::optional<double> least;
  for (const BodySpec& body : case_.bodies)
    if (const auto* layer = std::get_if<SurfaceLayer>(&body.region)) {
      const PlanRaster& t = layer->thickness;
      for (int row = 0; row < t.rows; ++row)
        for (int column = 0; column < t.columns; ++column) {
          if (!(t.at(column, row) > 0)) continue;
          const PlanFoot foot = path.foot_of(t.middle(column, row));
          const double distance =
              foot.is_before || foot.is_beyond ? length(t.middle(column, row) - path.at(foot.s)) : foot.distance;
          least = std::min(least.value_or(distance), distance);
        }
    }
  return least;
}

}  // namespace

void check_gauges(const Case& case_, std::vector<Mistake>& mistakes) {
  for (const Gauge& gauge : case_.gauges) {
    MistakesOf section(mistakes, {"gauge", gauge.name});
    if (!is_plain(gauge.name)) section.add("has a name that is not made of letters, digits, _ and -: it heads columns");
    if (std::ranges::count(case_.gauges, gauge.name, &Gauge::name) > 1) section.add("has the name of another gauge");
    if (!case_.map)
      section.add("goes with a [terrain] only");
    else if (gauge.points.empty())
      section.add("names no place");
    else if (const std::string fault = fault_of_points(gauge.points, case_); !fault.empty())
      section.add(fault);
  }

  if (!case_.thalweg) return;
  MistakesOf section(mistakes, {"thalweg"});
  const Thalweg& thalweg = *case_.thalweg;
  if (!case_.map) return section.add("goes with a [terrain] only");
  if (thalweg.points.size() < 2) return section.add("needs two points or more");
  if (const std::string fault = fault_of_points(thalweg.points, case_); !fault.empty()) return section.add(fault);
  if (!(thalweg.width > 0) || !std::isfinite(thalweg.width))
    return section.add(keys::thalweg_width.key, "must be above 0");
  const auto distance = distance_from_release(PlanPath(thalweg.points), case_);
  if (distance && *distance > 0.5 * thalweg.width)
    section.add(fmt::format("passes {} beside the release; half of its `width` is {}: is it the line of this slope?",
                            with_unit(std::round(*distance), "m"), with_unit(0.5 * thalweg.width, "m")));
}

}  // namespace talus
