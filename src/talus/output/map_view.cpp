#include "talus/output/map_view.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "talus/input/geodata.hpp"
#include "talus/output/packing.hpp"
#include "talus/output/page.hpp"
#include "talus/output/page_parts.hpp"
#include "talus/output/terrain_maps.hpp"

namespace talus {

namespace {

/// The part of a raster that the page shows.
struct PixelBox {
  int columns_from, columns_to, rows_from, rows_to;
};

/// Pixels that material has touched, with two around them.
PixelBox reached(const PlanRaster& thickness) {
  PixelBox box{thickness.columns, 0, thickness.rows, 0};
  for (int row = 0; row < thickness.rows; ++row)
    for (int column = 0; column < thickness.columns; ++column)
      if (thickness.at(column, row) > 0) {
        box.columns_from = std::min(box.columns_from, column - 2);
        box.columns_to = std::max(box.columns_to, column + 3);
        box.rows_from = std::min(box.rows_from, row - 2);
        box.rows_to = std::max(box.rows_to, row + 3);
      }
  if (box.columns_to == 0) return {0, thickness.columns, 0, thickness.rows};
  return {std::max(0, box.columns_from), std::min(thickness.columns, box.columns_to), std::max(0, box.rows_from),
          std::min(thickness.rows, box.rows_to)};
}

std::string packed_element(const std::string& id, const std::string& words) {
  return fmt::format("<script type=\"text/plain\" id=\"{}\">{}</script>\n", id, words);
}

/// Packs a map and returns its scale.
nlohmann::json add_map(const std::string& id, const PlanRaster& raster, const PixelBox& box, std::string& html) {
  if (raster.columns < box.columns_to || raster.rows < box.rows_to)
    throw std::runtime_error("the maps of the run differ in their pixels");
  std::vector<double> values;
  for (int row = box.rows_from; row < box.rows_to; ++row)
    for (int column = box.columns_from; column < box.columns_to; ++column) values.push_back(raster.at(column, row));
  const Packed packed = packed_values(values);
  html += packed_element(id, packed.words);
  return packed.facts;
}

/// Heights of the ground as the map gives them, on fewer pixels where it has very many.
nlohmann::json add_ground(const Terrain& ground, double most_pixels, std::string& html) {
  const PlanRaster& map = ground.heights();
  const int every = std::max(1, int(std::ceil(std::sqrt(double(map.columns) * map.rows / most_pixels))));
  const int columns = (map.columns + every - 1) / every, rows = (map.rows + every - 1) / every;
  std::vector<double> heights;
  nlohmann::json gaps = nlohmann::json::array();
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      double sum = 0;
      int n = 0;
      for (int r = row * every; r < std::min(map.rows, (row + 1) * every); ++r)
        for (int c = column * every; c < std::min(map.columns, (column + 1) * every); ++c)
          if (map.has(c, r)) {
            sum += map.at(c, r);
            ++n;
          }
      if (n == 0) gaps.push_back(heights.size());
      heights.push_back(n > 0 ? sum / n : ground.lowest());
    }
  const Packed packed = packed_places(heights);
  html += packed_element("map-heights", packed.words);
  return {{"corner", {map.corner[0], map.corner[1]}},
          {"pixel", map.pixel * every},
          {"columns", columns},
          {"rows", rows},
          {"low", packed.facts["low"]},
          {"step", packed.facts["step"]},
          {"gaps", gaps}};
}

/// How deep inside a solid the vertical line above a place reaches [m]; negative: the distance at which it passes.
double depth_above(const Solid& solid, const Terrain& ground, const Vec<2>& at, double top, double step) {
  double depth = -INFINITY;
  for (double z = ground.at(at[0], at[1]).height; z <= top;) {
    const double distance = solid.near({at[0], at[1], z}, Pose{}, 3).distance;
    depth = std::max(depth, -distance);
    z += std::max(step, std::abs(distance));
  }
  return depth;
}

std::vector<PlanLine> outlines_of(const Solid& solid, const Case& case_) {
  const Box &domain = case_.domain, box = solid.hollow ? domain : bounding_box(solid.shape, 3, domain);
  Vec<2> low, edges;
  for (int a : {0, 1}) {
    low[a] = std::max(box.min[a], domain.min[a]);
    edges[a] = std::min(box.max[a], domain.max[a]) - low[a];
  }
  if (!(edges[0] > 0 && edges[1] > 0)) return {};
  // A solid is at least as thick as a cell. Corners are rounded off by a pixel.
  constexpr double most_pixels = 2e5;
  const double pixel = std::max(std::min(0.25 * case_.cell, 0.01 * std::max(edges[0], edges[1])),
                                std::sqrt(edges[0] * edges[1] / most_pixels));
  // With pixels around, where there is nothing, so that lines are closed.
  PlanRaster depth = PlanRaster::of(low - Vec<2>{1.5 * pixel, 1.5 * pixel}, pixel, int(edges[0] / pixel) + 4,
                                    int(edges[1] / pixel) + 4, -pixel);
  for (int row = 0; row < depth.rows; ++row)
    for (int column = 0; column < depth.columns; ++column) {
      const Vec<2> at = depth.middle(column, row);
      double here = depth_above(solid, *case_.map->ground, at, box.max[2], 0.5 * pixel);
      for (int a : {0, 1}) here = std::min({here, at[a] - domain.min[a], domain.max[a] - at[a]});
      if (std::isfinite(here)) depth.at(column, row) = here;
    }
  return contour_lines(depth, 0);
}

}  // namespace

std::vector<MapOverlay> solid_outlines_of(const Case& case_) {
  std::vector<MapOverlay> overlays;
  for (const Solid& solid : case_.solids)
    if (!std::holds_alternative<Ground>(solid.shape))
      if (std::vector<PlanLine> lines = outlines_of(solid, case_); !lines.empty())
        overlays.push_back({solid.name, "solid", std::move(lines)});
  return overlays;
}

std::vector<MapOverlay> zone_outlines_of(const Case& case_) {
  std::vector<MapOverlay> overlays;
  for (const Solid& solid : case_.solids)
    for (std::size_t i = 0; i < solid.zones.surfaces.size(); ++i) {
      PlanRaster mask = solid.zones.number;
      for (double& number : mask.values) number = number == double(i) ? 1 : 0;
      overlays.push_back({"Zone " + (i < solid.zones.names.size() ? solid.zones.names[i] : std::to_string(i + 1)),
                          "zone", outlines_of(mask)});
    }
  return overlays;
}

std::vector<MapOverlay> overlays_of(const Case& case_) {
  std::vector<MapOverlay> overlays = zone_outlines_of(case_);
  overlays.push_back({"Release", "release", outlines_of(release_of(case_))});
  for (MapOverlay& solid : solid_outlines_of(case_)) {
    solid.name = "Solid " + solid.name;
    overlays.push_back(std::move(solid));
  }
  if (case_.thalweg) overlays.push_back({"Thalweg", "line", {case_.thalweg->points}});
  for (const Gauge& gauge : case_.gauges)
    overlays.push_back({"Gauge " + gauge.name, gauge.is_line() ? "line" : "point", {gauge.points}});
  return overlays;
}

std::string map_view(const std::filesystem::path& folder, const Case& case_, const std::string& case_text,
                     const MapBudget& budget) {
  const MapFrame& frame = case_.map->frame;
  const auto read = [&](const std::filesystem::path& file) {
    PlanRaster raster = read_geo_raster(file.string(), 1, RasterContent::results).raster;
    make_relative(raster, frame.origin);
    return raster;
  };
  struct Layer {
    const char *id, *name, *unit, *scale;
  };
  static constexpr Layer layers[] = {
      {"pft", "Peak flow thickness", "m", "linear"},          {"pfv", "Peak flow speed", "m/s", "linear"},
      {"ppr", "Peak dynamic pressure", "kPa", "logarithmic"}, {"arrival", "Time of arrival", "s", "linear"},
      {"deposit", "Deposit thickness", "m", "linear"},        {"change", "Change of the surface", "m", "about_zero"}};
  std::string data;
  nlohmann::json scene;
  const PlanRaster peak = read(map_file(folder, case_, case_text, "pft"));
  const PixelBox box = reached(peak);
  scene["origin"] = {frame.origin[0], frame.origin[1]};
  scene["projection"] = name_of_projection(frame.projection);
  scene["title"] = case_.title;
  scene["least_thickness"] = *case_.output.maps.least_thickness;
  scene["ground"] = add_ground(*case_.map->ground, budget.ground_pixels, data);
  scene["pixels"] = {
      {"corner", {peak.corner[0] + box.columns_from * peak.pixel, peak.corner[1] + box.rows_from * peak.pixel}},
      {"pixel", peak.pixel},
      {"columns", box.columns_to - box.columns_from},
      {"rows", box.rows_to - box.rows_from}};
  for (const Layer& layer : layers) {
    const PlanRaster raster = read(map_file(folder, case_, case_text, layer.id));
    const std::string id = fmt::format("map-{}", layer.id);
    scene["layers"].push_back({{"id", layer.id},
                               {"name", layer.name},
                               {"unit", layer.unit},
                               {"scale", layer.scale},
                               {"packed", add_map(id, raster, box, data)}});
  }
  const std::vector<MapFiles> frames = map_frames(folder);
  std::string frames_data;
  const auto add_frames = [&](std::size_t n_shown) {
    frames_data.clear();
    scene["frames"] = nlohmann::json::array();
    for (std::size_t i : spread_out(frames.size(), n_shown)) {
      const std::size_t n = scene["frames"].size();
      scene["frames"].push_back(
          {{"time", frames[i].time},
           {"thickness", add_map(fmt::format("map-thickness-{}", n), read(frames[i].thickness), box, frames_data)},
           {"speed", add_map(fmt::format("map-speed-{}", n), read(frames[i].speed), box, frames_data)}});
    }
  };
  std::size_t n_shown = std::min(frames.size(), budget.frames);
  add_frames(n_shown);
  while (n_shown > 1 && data.size() + frames_data.size() > budget.bytes) {
    const double room = budget.bytes > data.size() ? double(budget.bytes - data.size()) : 0;
    n_shown = std::clamp<std::size_t>(std::size_t(double(n_shown) * room / double(frames_data.size())), 1, n_shown - 1);
    add_frames(n_shown);
  }
  data += frames_data;
  const std::string note = n_shown == frames.size() ? ""
                                                    : fmt::format(
                                                          "<p class=\"note\">The map shows {} of {} instants, to limit "
                                                          "the size of the page; all are in the folder maps.</p>\n",
                                                          n_shown, frames.size());
  scene["overlays"] = nlohmann::json::array();
  for (const MapOverlay& overlay : overlays_of(case_)) {
    nlohmann::json lines = nlohmann::json::array();
    for (const PlanLine& line : overlay.lines) {
      lines.push_back(nlohmann::json::array());
      for (const Vec<2>& x : line) lines.back().push_back({x[0], x[1]});
    }
    scene["overlays"].push_back({{"name", overlay.name}, {"kind", overlay.kind}, {"lines", lines}});
  }
  return std::string(page_parts::map_html()) + note + data + embedded_json("map-scene", scene.dump()) +
         embedded_script(page_parts::map_js());
}

}  // namespace talus
