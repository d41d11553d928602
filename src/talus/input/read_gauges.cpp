#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "talus/base/units.hpp"
#include "talus/geometry/plan_path.hpp"
#include "talus/input/map_files.hpp"

namespace talus {

namespace {

constexpr Numbers place_of_gauge{{"at", "m", {}, "a place, east and north on the map"}, 2},
    begin_of_gauge{{"from", "m", {}, "where a line begins, on the map; flow to the left of it counts as positive"}, 2},
    end_of_gauge{{"to", "m", {}, "where the line ends"}, 2};
constexpr Text file_of_gauge{"line", "a line: a shapefile, GeoPackage or GeoJSON"};
constexpr Text file_of_thalweg{"line", "the line: a shapefile, GeoPackage or GeoJSON"};
constexpr Points points_of_thalweg{{"points", "m", {}, "the line, from point to point on the map, east and north"}, 2};

/// A place of the map in the coordinates of the run.
Vec<2> in_run(const std::vector<double>& place, const Case& case_) {
  if (place.size() != 2 || !case_.map) return {};
  return Vec<2>{place[0], place[1]} - case_.map->frame.origin;
}

bool is_known_at(const Case& case_, const Vec<2>& x) { return case_.map->ground->is_known_up_to_edge(x[0], x[1]); }
double height_at(const Case& case_, const Vec<2>& x) { return case_.map->ground->at(x[0], x[1]).height; }

/// Complains where there is no terrain, unless there should be one.
void expect_terrain(Section& root, Section& s, const Case& case_) {
  if (!case_.map && !root.has("terrain")) s.complain("goes with a [terrain] only");
}

std::vector<Vec<2>> read_line_of(Section& s, const Text& key, const std::string& folder, Case& case_) {
  if (case_.map) return read_map_line(s, key, folder, *case_.map);
  s.text(key);
  return {};
}

std::vector<Vec<2>> read_points_of_gauge(Section& s, const std::string& folder, Case& case_) {
  s.expect_one_of();
  std::vector<Vec<2>> points;
  if (s.has("at")) points = {in_run(s.numbers(place_of_gauge), case_)};
  if (s.has("line")) points = read_line_of(s, file_of_gauge, folder, case_);
  if (!s.has("from")) {
    expect_absent(s, {"to"}, "from");
    return points;
  }
  const std::vector<double> from = s.numbers(begin_of_gauge);
  if (!s.has("to")) {
    s.complain("`to` is missing: where the line ends");
    return {};
  }
  return {in_run(from, case_), in_run(s.numbers(end_of_gauge), case_)};
}

void note_gauge(Section& s, const std::vector<Vec<2>>& points, const Case& case_) {
  if (!s.is_right() || !case_.map) return;
  if (points.size() > 1)
    s.note("length", fmt::format("{:.6g} m", PlanPath(points).length()), "of the line, in plan");
  else if (points.size() == 1 && is_known_at(case_, points[0]))
    s.note("height", fmt::format("{:.6g} m", height_at(case_, points[0])), "of the ground there");
}

/// Makes a thalweg begin where the ground is higher.
void turn_downhill(Section& s, Thalweg& thalweg, const Case& case_) {
  std::vector<Vec<2>>& points = thalweg.points;
  if (!s.is_right() || points.size() < 2 || !is_known_at(case_, points.front()) || !is_known_at(case_, points.back()))
    return;
  if (height_at(case_, points.front()) < height_at(case_, points.back())) std::ranges::reverse(points);
  const double top = height_at(case_, points.front()), foot = height_at(case_, points.back());
  s.note("size",
         fmt::format("{:.6g} m long in plan, from {:.6g} m down to {:.6g} m", PlanPath(points).length(), top, foot),
         "of the thalweg, from its higher end");
}

void read_thalweg(Section& root, Case& case_, const std::string& folder) {
  if (!root.has("thalweg")) return;
  Section s = root.section(keys::thalweg);
  expect_terrain(root, s, case_);
  s.expect_one_of();
  Thalweg thalweg;
  if (s.has("line")) thalweg.points = read_line_of(s, file_of_thalweg, folder, case_);
  if (s.has("points"))
    for (const std::vector<double>& point : s.points(points_of_thalweg)) thalweg.points.push_back(in_run(point, case_));
  thalweg.width = s.number(keys::thalweg_width);
  s.close();
  if (!s.is_right() || !case_.map) return;
  turn_downhill(s, thalweg, case_);
  case_.thalweg = std::move(thalweg);
}

}  // namespace

const Declaration& gauge_declaration() {
  static const Declaration d(
      "a gauge", {optional(place_of_gauge), optional(begin_of_gauge), depends(end_of_gauge), optional(file_of_gauge)},
      {"at", "from", "line"});
  return d;
}

const Declaration& thalweg_declaration() {
  static const Declaration d("[thalweg]",
                             {optional(file_of_thalweg), optional(points_of_thalweg), required(keys::thalweg_width)},
                             {"line", "points"});
  return d;
}

void read_gauges(Section& root, Case& case_, const std::string& folder) {
  if (root.has("gauge"))
    for (auto& [name, s] : root.named_sections(keys::gauges)) {
      expect_terrain(root, s, case_);
      Gauge gauge{name, read_points_of_gauge(s, folder, case_)};
      s.close();
      note_gauge(s, gauge.points, case_);
      if (case_.map && !gauge.points.empty()) case_.gauges.push_back(std::move(gauge));
    }
  read_thalweg(root, case_, folder);
}

}  // namespace talus
