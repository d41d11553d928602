#pragma once
/// Runout along a thalweg, and the flow along it in time.
///
/// s [m] is the distance along the thalweg in plan from its higher end. A pixel of the maps belongs to the thalweg where
/// its middle is no farther from it than half the width; its s is that of the nearest point of the thalweg. Pixels
/// whose nearest point is an end, and which lie past that end, do not count.

#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/geometry/plan_path.hpp"
#include "talus/output/flow_maps.hpp"
#include "talus/output/picture.hpp"

namespace talus {

/// How far a flow went along a thalweg. Flow is what exceeds the least thickness, by the middles of pixels.
struct ThalwegRunout {
  double thalweg = 0;         ///< length of the thalweg [m]
  double release = 0;         ///< s where flow begins at the first instant: the upper end of the release [m]
  double runout = 0;          ///< s of the farthest flow [m]
  double length = 0;          ///< from `release` to `runout` along the thalweg, in plan [m]
  double top = 0, foot = 0;   ///< height of the thalweg there [m]
  double share_beside = 0;    ///< of the area where flow has been, that lies beside the strip, 0 to 1
  bool starts_above = false;  ///< there was flow before the thalweg's beginning: drop and length are lower bounds
  bool passes_end = false;    ///< flow has gone past the thalweg's end: runout and length are lower bounds

  double drop() const { return top - foot; }  ///< [m]
  /// Drop over length; its arctangent is the angle of reach. 0 if nothing moved.
  double ratio() const { return length > 0 ? drop() / length : 0; }
  double angle() const;  ///< of reach [degrees]
};

/// What files and columns of an instant [s] have in their names: t00012.0. Decimals are as many as tell the instants of
/// `output.pictures` apart, at least one.
std::string name_of_instant(const Case& case_, double time);

/// Collects the flow along the thalweg of a case during a run.
class ThalwegProfile {
 public:
  /// Of a case with a thalweg, on the pixels of its maps; `state` is what `state()` returned before the run was stopped.
  ThalwegProfile(const Case& case_, const PlanRaster& pixels, std::span<const double> state = {});

  /// Adds an instant [s] to the columns of profile.csv.
  void add(double time, const FlowMap& map);
  /// Everything that decides what is to come; finite numbers.
  std::vector<double> state() const;

  /// None if no flow has been in the strip.
  std::optional<ThalwegRunout> runout(const FlowMaps& maps) const;
  /// Writes profile.csv. `release`: upright thickness on the pixels of the maps [m].
  void write(const std::filesystem::path& csv, const FlowMaps& maps, const FlowMap& end,
             const PlanRaster& release) const;
  /// Draws profile.csv as NAME.png. None without gnuplot.
  std::optional<Picture> draw(const std::filesystem::path& png, const std::filesystem::path& csv, const FlowMaps& maps,
                              const PlanRaster& release) const;

 private:
  /// A place on the thalweg, in the middle of a stretch about as long as a pixel.
  struct Station {
    double s;
    Vec<2> at;
    double ground;  ///< height [m]
  };
  /// A pixel of the strip, and the stations that it reaches.
  struct Beside {
    std::size_t pixel;
    double s;
    int first, last;
  };
  /// At the stations, across the strip.
  struct Instant {
    double time;
    std::vector<double> thickness, vertical_thickness, speed;
  };
  /// The largest number of a map across the strip at each station, or the least; none where it has none.
  std::vector<double> across(const PlanRaster& map, bool least = false) const;
  std::vector<double> thickness_of_release(const PlanRaster& release) const;

  const Case& case_;
  PlanPath path_;
  std::vector<Station> stations_;
  std::vector<Beside> strip_;
  std::vector<std::size_t> above_, past_;  ///< pixels before the beginning and beyond the end, as near to the line
  std::vector<Instant> instants_;
};

}  // namespace talus
