#include "talus/output/terrain_maps.hpp"

#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <zlib.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <numeric>

#include "talus/base/file.hpp"
#include "talus/base/units.hpp"
#include "talus/case/defaults.hpp"
#include "talus/mpm/start/filling.hpp"
#include "talus/output/map_picture.hpp"
#include "talus/output/map_view.hpp"
#include "talus/output/raster_file.hpp"

namespace talus {

namespace {

namespace fs = std::filesystem;

/// A name without what separates the parts of a file's name.
std::string plain(const std::string& name) {
  std::string text;
  for (const char c : name)
    if (std::isalnum(static_cast<unsigned char>(c))) text += c;
  return text.empty() ? "release" : text;
}

/// Stands for `none` in the state of a run: no map holds a negative number, and JSON knows no NaN.
constexpr double no_number = -1;

fs::path frames_of(const fs::path& folder) { return folder / "frames"; }
fs::path list_of_frames(const fs::path& folder) { return frames_of(folder) / "frames.json"; }
fs::path file_of_frame(const fs::path& folder, std::size_t number, const char* what) {
  return frames_of(folder) / fmt::format("frame_{:04d}_{}.tif", number, what);
}

PlanRaster scaled(PlanRaster raster, double factor) {
  for (double& value : raster.values) value *= factor;
  return raster;
}

/// Of the sets of pixels with a number that touch, if only by their corners, the largest; the others have none.
PlanRaster connected(const PlanRaster& raster) {
  std::vector<int> set_of(raster.values.size(), 0);
  std::vector<std::size_t> sizes{0};
  std::vector<std::array<int, 2>> ahead;
  const auto visit = [&](int column, int row) {
    if (!raster.has(column, row) || set_of[raster.index(column, row)] > 0) return;
    set_of[raster.index(column, row)] = int(sizes.size()) - 1;
    ++sizes.back();
    ahead.push_back({column, row});
  };
  for (int row = 0; row < raster.rows; ++row)
    for (int column = 0; column < raster.columns; ++column) {
      sizes.push_back(0);
      visit(column, row);
      while (!ahead.empty()) {
        const auto [c, r] = ahead.back();
        ahead.pop_back();
        for (int i = -1; i <= 1; ++i)
          for (int j = -1; j <= 1; ++j) visit(c + i, r + j);
      }
      if (sizes.back() == 0) sizes.pop_back();
    }
  const int largest = int(std::ranges::max_element(sizes) - sizes.begin());
  PlanRaster part = raster;
  for (std::size_t i = 0; i < part.values.size(); ++i)
    if (set_of[i] != largest) part.values[i] = PlanRaster::none;
  return part;
}

/// To the farthest pixel with a number.
FlowReach reach_of(const PlanRaster& raster, const Vec<2>& top, const MapOfCase& map) {
  FlowReach reach;
  const double top_height = map.ground->at(top[0], top[1]).height;
  for (int row = 0; row < raster.rows; ++row)
    for (int column = 0; column < raster.columns; ++column) {
      if (!raster.has(column, row)) continue;
      const Vec<2> at = raster.middle(column, row);
      if (const double distance = length(at - top); distance > reach.length)
        reach = {top_height - map.ground->at(at[0], at[1]).height, distance, at + map.frame.origin};
    }
  return reach;
}

/// In plan, of the pixels with a number [m2].
double area_of(const PlanRaster& raster) {
  return double(std::ranges::count_if(raster.values, [](double v) { return !std::isnan(v); })) * raster.pixel *
         raster.pixel;
}

MapPicture picture_of(const Case& case_) {
  MapPicture picture;
  picture.title = case_.title;
  picture.ground = case_.map->ground.get();
  picture.frame = case_.map->frame;
  picture.release_mask = release_of(case_);
  picture.domain = PlanBox{{case_.domain.min[0], case_.domain.min[1]}, {case_.domain.max[0], case_.domain.max[1]}};
  picture.cell = case_.cell;
  for (const MapOverlay& zone : zone_outlines_of(case_)) picture.zones.push_back({zone.name, zone.lines});
  for (const MapOverlay& solid : solid_outlines_of(case_)) picture.solids.push_back({solid.name, solid.lines});
  for (const Gauge& gauge : case_.gauges) picture.gauges.push_back({gauge.name, gauge.points});
  if (case_.thalweg) {
    picture.thalweg = case_.thalweg->points;
    picture.thalweg_width = case_.thalweg->width;
  }
  return picture;
}

}  // namespace

PlanRaster pixels_of_maps(const Case& case_) {
  const PlanRaster& heights = case_.map->ground->heights();
  const double pixel = *case_.output.maps.pixel;
  const Vec<2> far = heights.far_corner();
  return PlanRaster::of(heights.corner, pixel, int(std::ceil((far[0] - heights.corner[0]) / pixel - 1e-9)),
                        int(std::ceil((far[1] - heights.corner[1]) / pixel - 1e-9)));
}

double checksum_of_maps(const Case& case_) {
  unsigned long sum = 0;
  const auto add_numbers = [&](const auto& numbers) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(numbers.data());  // NOLINT: zlib's type
    sum = ::crc32_z(sum, bytes, numbers.size() * sizeof(numbers[0]));
  };
  const auto add = [&](const PlanRaster& raster) { add_numbers(raster.values); };
  for (const Solid& solid : case_.solids)
    if (const auto* mesh = std::get_if<Mesh>(&solid.shape)) {
      add_numbers(mesh->surface->corners());
      add_numbers(mesh->surface->triangles());
    }
  if (!case_.map) return double(sum);
  add(case_.map->ground->heights());
  for (const Solid& solid : case_.solids) add(solid.zones.number);
  for (const BodySpec& body : case_.bodies)
    if (const auto* layer = std::get_if<SurfaceLayer>(&body.region)) {
      add(layer->thickness);
      if (layer->base != case_.map->ground) add(layer->base->heights());
    }
  const auto add_line = [&](const std::vector<Vec<2>>& points) {
    const auto* bytes = reinterpret_cast<const unsigned char*>(points.data());  // NOLINT: zlib's type
    if (!points.empty()) sum = ::crc32_z(sum, bytes, points.size() * sizeof(points[0]));
  };
  for (const Gauge& gauge : case_.gauges) add_line(gauge.points);
  if (case_.thalweg) add_line(case_.thalweg->points);
  return double(sum);
}

PlanRaster release_of(const Case& case_) {
  PlanRaster release = pixels_of_maps(case_);
  std::ranges::fill(release.values, 0.0);
  const double area = release.pixel * release.pixel;
  for (const BodySpec& body : case_.bodies)
    if (const auto* layer = std::get_if<SurfaceLayer>(&body.region))
      for_each_point(*layer, [&](const Vec<3>& x, double volume) {
        const int column = release.column_of(x[0]), row = release.row_of(x[1]);
        if (release.has_pixel(column, row)) release.at(column, row) += volume / area;
      });
  return release;
}

std::string name_of_maps(const Case& case_, const std::string& case_text) {
  const auto number =
      ::crc32_z(0, reinterpret_cast<const unsigned char*>(case_text.data()), case_text.size());  // NOLINT: zlib's type
  return fmt::format("{}_{:08x}_null_talus", plain(case_.bodies.front().name), number);
}

fs::path map_file(const fs::path& folder, const Case& case_, const std::string& case_text, const std::string& what) {
  return folder /
         fmt::format("{}_{}.{}", name_of_maps(case_, case_text), what, case_.map && case_.map->geotiff ? "tif" : "asc");
}

std::vector<MapFiles> map_frames(const fs::path& folder) {
  std::vector<MapFiles> frames;
  const fs::path list = list_of_frames(folder);
  if (!fs::exists(list)) return frames;
  try {
    for (const auto& frame : nlohmann::json::parse(contents_of(list)))
      frames.push_back({frame.at("time"), list.parent_path() / frame.at("thickness").get<std::string>(),
                        list.parent_path() / frame.at("speed").get<std::string>()});
  } catch (const std::exception& e) {
    throw std::runtime_error(fmt::format("the list of maps {} could not be read: {}", list.string(), e.what()));
  }
  return frames;
}

TerrainMaps::TerrainMaps(fs::path folder, const Case& case_, const std::string& case_text,
                         std::span<const double> so_far, std::span<const double> profile_so_far)
    : folder_(std::move(folder)), case_(case_) {
  if (!case_.map) return;
  name_ = name_of_maps(case_, case_text);
  next_frame_.interval = case_.output.maps.frames.value_or(default_map_frames(case_).value);
  if (!so_far.empty()) {  // the frames stand before the rest
    const auto n = std::size_t(so_far[2]);
    next_frame_.next = so_far[0];
    next_frame_.last = so_far[1];
    frame_times_.assign(so_far.begin() + 3, so_far.begin() + 3 + std::ptrdiff_t(n));
    so_far = so_far.subspan(3 + n);
  }
  std::vector<double> state(so_far.begin(), so_far.end());
  std::ranges::replace(state, no_number, PlanRaster::none);
  maps_.emplace(*case_.map->ground, pixels_of_maps(case_), *case_.output.maps.interval,
                *case_.output.maps.least_thickness, state);
  if (case_.thalweg) profile_.emplace(case_, pixels_of_maps(case_), profile_so_far);
  fs::create_directories(frames_of(folder_));
  // Frames of another run, or of one that has gone further, are removed.
  std::vector<fs::path> later;
  for (const auto& entry : fs::directory_iterator(frames_of(folder_))) {
    int number;
    const std::string file = entry.path().filename();
    if (std::sscanf(file.c_str(), "frame_%d_", &number) == 1 && number >= int(frame_times_.size()))
      later.push_back(entry.path());
  }
  for (const fs::path& path : later) fs::remove(path);
  list_frames();
}

std::vector<double> TerrainMaps::state() const {
  if (!maps_) return {};
  std::vector<double> state = {next_frame_.next, next_frame_.last, double(frame_times_.size())};
  state.insert(state.end(), frame_times_.begin(), frame_times_.end());
  const std::vector<double> peaks = maps_->state();
  state.insert(state.end(), peaks.begin(), peaks.end());
  std::ranges::replace_if(
      state, [](double x) { return std::isnan(x); }, no_number);
  return state;
}

void TerrainMaps::list_frames() const {
  nlohmann::json frames = nlohmann::json::array();
  for (std::size_t i = 0; i < frame_times_.size(); ++i)
    frames.push_back({{"time", frame_times_[i]},
                      {"thickness", file_of_frame(folder_, i, "thickness").filename().string()},
                      {"speed", file_of_frame(folder_, i, "speed").filename().string()}});
  write_whole(list_of_frames(folder_), frames.dump(1) + "\n");
}

void TerrainMaps::write_frame(double time, const FlowMap& map) {
  const std::size_t number = frame_times_.size();
  const auto write = [&](const char* what, const PlanRaster& raster, const char* unit, const char* meaning) {
    write_raster(file_of_frame(folder_, number, what), raster, case_.map->frame, RasterFormat::geotiff, unit,
                 fmt::format("{} at {:.6g} s", meaning, time));
  };
  write("thickness", map.thickness, "m", "Thickness normal to the ground");
  write("speed", map.speed, "m/s", "Speed");
  frame_times_.push_back(time);
  list_frames();
}

void TerrainMaps::write_raster_of(const fs::path& folder, const std::string& what, const PlanRaster& raster,
                                  const std::string& unit, const std::string& meaning) const {
  const bool tiff = case_.map->geotiff;
  write_raster(folder / fmt::format("{}_{}.{}", name_, what, tiff ? "tif" : "asc"), raster, case_.map->frame,
               tiff ? RasterFormat::geotiff : RasterFormat::asc, unit, meaning);
}

void TerrainMaps::write_instant(double time, const FlowPoints& points) {
  const FlowMap map = maps_->now(points);
  const std::string at = name_of_instant(case_, time);
  // In a folder of their own: AIMEC takes every raster beside the peaks for a result of a simulation.
  const fs::path instants = folder_ / "instants";
  fs::create_directories(instants);
  write_raster_of(instants, "thickness_" + at, map.thickness, "m", "Thickness normal to the ground");
  write_raster_of(instants, "speed_" + at, map.speed, "m/s", "Speed");
  if (profile_) profile_->add(time, map);
}

Runout TerrainMaps::runout(const FlowMap& end) const {
  Runout out;
  const PlanRaster &peak = maps_->peak_speed(), release = release_of(case_);
  const double area = peak.pixel * peak.pixel;
  Vec<2> top{};
  double top_height = -INFINITY;
  for (int row = 0; row < peak.rows; ++row)
    for (int column = 0; column < peak.columns; ++column) {
      out.released += release.at(column, row) * area;
      out.deposited += end.vertical_thickness.at(column, row) * area;
      out.thickness = std::max(out.thickness, maps_->peak_thickness().at(column, row));
      const Vec<2> at = peak.middle(column, row);
      const double height = case_.map->ground->at(at[0], at[1]).height;
      if (release.at(column, row) > 0 && height > top_height) {
        top = at;
        top_height = height;
      }
    }
  for (const double speed : peak.values) out.speed = std::fmax(out.speed, speed);  // the larger that is a number
  const PlanRaster together = connected(peak);
  out.area = area_of(peak);
  out.reach = reach_of(peak, top, *case_.map);
  out.connected_area = area_of(together);
  out.connected = reach_of(together, top, *case_.map);
  return out;
}

PlanRaster TerrainMaps::change_of_surface(const FlowMap& end) {
  FlowPoints start;
  for (const BodySpec& body : case_.bodies) {
    const Filling filling = fill(case_, body);
    start.places.insert(start.places.end(), filling.points.begin(), filling.points.end());
    start.volumes.insert(start.volumes.end(), filling.volumes.begin(), filling.volumes.end());
  }
  start.velocities.resize(start.places.size());
  start.masses = start.volumes;  // of no use here
  const FlowMap before = maps_->now(start);
  PlanRaster change = end.vertical_thickness;
  for (std::size_t i = 0; i < change.values.size(); ++i) change.values[i] -= before.vertical_thickness.values[i];
  return change;
}

MapsAtEnd TerrainMaps::write(double time, const FlowPoints& points) {
  MapsAtEnd result;
  if (!maps_) return result;
  const FlowMap end = maps_->now(points);
  if (frame_times_.empty() || frame_times_.back() < time) write_frame(time, end);
  const double least = *case_.output.maps.least_thickness;
  struct Map {
    const char *what, *words, *unit;
    PlanRaster values;
    std::optional<double> hidden_to;
    MapScale scale = MapScale::linear;
  };
  const Map all[] = {
      {"pft", "Peak flow thickness", "m", maps_->peak_thickness(), least},
      {"pfv", "Peak flow speed", "m/s", maps_->peak_speed(), 0},
      {"ppr", "Peak dynamic pressure", "kPa", scaled(maps_->peak_pressure(), 1e-3), 0, MapScale::logarithmic},
      {"arrival", "Time of arrival", "s", maps_->arrival(), std::nullopt},
      {"deposit", "Thickness at the end", "m", end.thickness, least},
      {"change", "Vertical rise of the surface", "m", change_of_surface(end), least, MapScale::about_zero}};
  for (const Map& map : all) {
    write_raster_of(folder_, map.what, map.values, map.unit, map.words);
    MapPicture picture = picture_of(case_);
    picture.layer = MapLayer{map.values, map.words, map.unit, map.hidden_to, map.scale};
    picture.notes = {fmt::format("until {:.1f} s", time)};
    const fs::path png = folder_ / fmt::format("{}.png", map.what);
    if (draw_map(png, picture)) result.pictures.push_back({png, fmt::format("{} [{}]", map.words, map.unit)});
  }
  write_raster_of(folder_, "depositvertical", end.vertical_thickness, "m", "Vertical thickness at the end");
  result.runout = runout(end);
  result.runout.particles = std::accumulate(points.volumes.begin(), points.volumes.end(), 0.0);
  result.runout.at_start = std::accumulate(points.volumes_at_start.begin(), points.volumes_at_start.end(), 0.0);
  if (!profile_) return result;
  const PlanRaster release = release_of(case_);
  const fs::path csv = folder_.parent_path() / "profile.csv";
  result.thalweg = profile_->runout(*maps_);
  profile_->write(csv, *maps_, end, release);
  if (const auto drawn = profile_->draw(folder_ / "profile.png", csv, *maps_, release))
    result.pictures.push_back(*drawn);
  return result;
}

bool draw_case_map(const fs::path& png, const Case& case_) {
  MapPicture picture = picture_of(case_);
  double volume = 0;
  for (const BodySpec& body : case_.bodies)
    if (std::holds_alternative<SurfaceLayer>(body.region)) volume += talus::volume(body.region, 3);
  picture.notes = {fmt::format("released: {} m3", three_digits(volume))};
  picture.view = picture.domain;
  return draw_map(png, picture);
}

}  // namespace talus
