#pragma once
/// Pictures of maps: terrain in grey with contour lines, a quantity in colours, release and domain.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "talus/geometry/terrain.hpp"
#include "talus/output/contour_lines.hpp"

namespace talus {

/// A rectangle of the plane, in coordinates of the run [m].
struct PlanBox {
  Vec<2> low{}, high{};
};

/// How colours go with values: about zero, blue below and red above, as far to both sides; with the logarithm over three
/// decades at most.
enum class MapScale { linear, logarithmic, about_zero };

/// A quantity in colours. Pixels without a number, or whose number is not above `hidden_to`, stay free; of those about
/// zero, whose magnitude is not.
struct MapLayer {
  PlanRaster values;
  std::string words;  ///< beside the colours: "Peak flow thickness"
  std::string unit;
  std::optional<double> hidden_to = 0;
  MapScale scale = MapScale::linear;
};

/// A gauge, with its name beside it: one point is a place, several are a line.
struct MapGauge {
  std::string name;
  PlanLine points;
};

/// A part of the plane: ground with a contact of its own, or what a solid covers.
struct MapArea {
  std::string name;
  std::vector<PlanLine> outlines;
};

/// What a picture shows. All places are in coordinates of the run; axes are in those of the map.
struct MapPicture {
  std::string title;
  const Terrain* ground = nullptr;  ///< required
  MapFrame frame;
  std::optional<MapLayer> layer;
  std::vector<PlanLine> release;           ///< outlines, closed or not
  std::optional<PlanRaster> release_mask;  ///< numbers above zero are release
  std::optional<PlanBox> domain;           ///< of the run
  std::vector<MapArea> zones;
  std::vector<MapArea> solids;
  std::vector<MapGauge> gauges;
  PlanLine thalweg;                ///< from its upper end, with an arrow at its lower one; empty: none
  double thalweg_width = 0;        ///< of the strip along it [m], for the legend
  double cell = 0;                 ///< edge of the run's cells [m]; 0: not shown
  std::vector<std::string> notes;  ///< short lines beside the map
  /// The part to be shown; if absent, what is drawn in colours with the release, else the domain, else all terrain,
  /// with a margin.
  std::optional<PlanBox> view;
};

/// Writes the script NAME.gp that draws NAME.png, and its data NAME_*.bin and NAME_*.txt, into a folder. Returns the script.
/// Throws std::runtime_error if a file cannot be written.
std::filesystem::path write_map_script(const std::filesystem::path& folder, const std::string& name,
                                       const MapPicture& picture);

/// Draws a picture, 1400 pixels wide at most; leaves no other file. False if gnuplot is not installed; throws
/// std::runtime_error if it fails or a file cannot be written.
bool draw_map(const std::filesystem::path& png, const MapPicture& picture);

/// A number with its digits in groups of three, as on maps: "1 234 500".
std::string grouped(double value, int decimals = 0);

/// A number with three digits, from 100 on in full: "0.0305", "32 453".
std::string three_digits(double value);

}  // namespace talus
