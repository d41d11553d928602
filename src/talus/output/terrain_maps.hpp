#pragma once
/// The maps that a run on terrain leaves: rasters for geographic information systems, and pictures of them.

#include <cmath>
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/output/checkpoint.hpp"
#include "talus/output/flow_maps.hpp"
#include "talus/output/picture.hpp"
#include "talus/output/thalweg_profile.hpp"

namespace talus {

/// The pixels of a case's maps, without numbers.
PlanRaster pixels_of_maps(const Case& case_);

/// A number made of all maps and meshes that a case has read, so that a run is not resumed on other ground; 0 without any.
double checksum_of_maps(const Case& case_);

/// What is released onto the ground of a case: upright thickness on the pixels of its maps [m].
PlanRaster release_of(const Case& case_);

/// From the highest place of the release to the farthest of some pixels [m].
struct FlowReach {
  double drop = 0, length = 0;
  Vec<2> farthest{};  ///< on the map

  double angle() const { return std::atan2(drop, length); }
};

/// What the maps of a run say in numbers.
struct Runout {
  double released = 0;   ///< volume at the start [m3]
  double deposited = 0;  ///< volume on the maps at the end [m3]
  /// Volume of the particles at the end [m3], as maps count it: particles without contact have 1.25 times their volume
  /// at the start at most. On the maps, but for what lies beside them.
  double particles = 0;
  double at_start = 0;  ///< volume that these particles had at the start [m3]
  /// Bulking factor: present volume over that at the start.
  double bulking() const { return at_start > 0 ? particles / at_start : 1; }
  double area = 0;  ///< in plan, where flow has been [m2]
  FlowReach reach;  ///< of all flow
  /// Connected flow: of the sets of pixels that touch, if only by their corners, the largest. Single particles that have
  /// run ahead are beside it.
  double connected_area = 0;
  FlowReach connected;
  double thickness = 0;  ///< largest of all [m], normal to the ground
  double speed = 0;      ///< largest of all [m/s]
};

/// Maps and their numbers at the end of a run.
struct MapsAtEnd {
  std::vector<Picture> pictures;  ///< none without gnuplot
  Runout runout;
  std::optional<ThalwegRunout> thalweg;  ///< none without a thalweg, or if no flow has been there
};

/// Thickness and speed at an instant of a run: GeoTIFF files on the pixels of its maps.
struct MapFiles {
  double time;  ///< [s]
  std::filesystem::path thickness, speed;
};

/// The name that all maps of a run have in common: RELEASE_ID_null_talus.
std::string name_of_maps(const Case& case_, const std::string& case_text);

/// The map of a whole run that shows `what` (pft, pfv, ...), in the folder of its maps; not every run has all.
std::filesystem::path map_file(const std::filesystem::path& folder, const Case& case_, const std::string& case_text,
                               const std::string& what);

/// The instants in the folder of a run's maps, in their order; none if there is no list of them. Throws
/// std::runtime_error if the list cannot be read.
std::vector<MapFiles> map_frames(const std::filesystem::path& folder);

/// Collects maps during a run. Files are named as AvaFrame's AIMEC reads them, RELEASE_ID_null_talus_WHAT: the first
/// body, a number made of the case, and pft (peak flow thickness, m), pfv (peak flow velocity, m/s), ppr (peak pressure,
/// kPa), arrival (s), or deposit (m); thickness is normal to the ground. GeoTIFF or ESRI ASC, as the terrain was.
/// `change` is how far the surface of all bodies has risen, upright (m): vertical thickness at the end less that at the
/// start, negative where material has gone. Where bodies are the ground itself, that is deposit and erosion.
class TerrainMaps {
 public:
  /// Does nothing in a case without terrain. `case_text` is what the number is made of, `so_far` and
  /// `profile_so_far` what `state` and `profile_state` gave before the run was stopped.
  TerrainMaps(std::filesystem::path folder, const Case& case_, const std::string& case_text,
              std::span<const double> so_far = {}, std::span<const double> profile_so_far = {});

  /// Whether an instant counts for peaks, or is the first after one.
  bool due(double time) const { return maps_ && maps_->due(time); }
  void add(double time, const FlowPoints& points) { maps_->add(time, points); }
  /// Whether thickness and speed are due for what the report plays, each `output.maps.frames`.
  bool frame_due(double time) { return maps_ && next_frame_.due(time); }
  void add_frame(double time, const FlowPoints& points) { write_frame(time, maps_->now(points)); }
  /// Everything that decides what is to come; finite numbers.
  std::vector<double> state() const;
  std::vector<double> profile_state() const { return profile_ ? profile_->state() : std::vector<double>{}; }

  /// Thickness and speed at an instant as rasters, in a case with terrain.
  void write_instant(double time, const FlowPoints& points);
  /// Peaks, arrival and deposit as rasters and pictures, the last frame, and the profile along the thalweg, at the end of a
  /// run.
  MapsAtEnd write(double time, const FlowPoints& points);

  bool any() const { return maps_.has_value(); }

 private:
  void write_frame(double time, const FlowMap& map);
  void list_frames() const;
  Runout runout(const FlowMap& end) const;
  PlanRaster change_of_surface(const FlowMap& end);
  void write_raster_of(const std::filesystem::path& folder, const std::string& what, const PlanRaster& raster,
                       const std::string& unit, const std::string& meaning) const;

  std::filesystem::path folder_;
  const Case& case_;
  std::string name_;  ///< of the files, without what they show
  std::optional<FlowMaps> maps_;
  Schedule next_frame_;
  std::vector<double> frame_times_;  ///< [s]
  std::optional<ThalwegProfile> profile_;
};

/// Draws the terrain of a case with what is released, domain, zones, gauges and thalweg. Returns whether there is gnuplot
/// to do it.
bool draw_case_map(const std::filesystem::path& png, const Case& case_);

}  // namespace talus
