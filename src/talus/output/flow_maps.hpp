#pragma once
/// Maps of a run on terrain: thickness, speed and dynamic pressure of the flow, and when it came.
///
/// How points become maps. The volume of a point is spread evenly over the square of its own width V^(1/3) around it in
/// plan. All that lies above a pixel is one column, also where material flies above other material. Of a column:
///   vertical thickness  volume / area of the pixel
///   thickness           normal to the ground: vertical thickness times the cosine of the ground's slope, in the
///                       middle of the pixel
///   velocity            mean, weighted with mass; the speed is its length
///   dynamic pressure    rho v^2, with rho = mass / volume of the column and v its speed; no factor 1/2, as in AvaFrame
/// Speed, pressure and arrival are known only where the vertical thickness exceeds a limit: a few particles thrown
/// ahead are no flow.
///
/// Kyburz and Gaume (2025, NHESS 25, 3897) bring scattered points of a three-dimensional material point method onto a
/// raster for the same purpose, with vertical depth kept apart from thickness normal to the slope, and velocities
/// averaged over the depth. We differ in three ways. Thickness is volume over area, not a distance between heights:
/// maps conserve volume, a particle thrown up does not make a flow thicker, and the gap below a flow that has left the
/// ground does not count; whether it has left the ground is not recorded. Speed is that of the mean velocity, not split into
/// parts parallel and normal to the slope. And a point covers an area, so that pixels may be smaller than the points
/// are far apart.
///
/// Where material is stretched along the ground until its points are farther apart than they are wide, there are gaps
/// between their squares; pixels should be as wide as the cells of the run.

#include <span>
#include <vector>

#include "talus/geometry/terrain.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus {

/// What a column of material is on a map.
struct ColumnFlow {
  double vertical_thickness, thickness;  ///< [m]; the second normal to the ground
  bool is_thick;                         ///< whether the vertical thickness exceeds the limit
  double speed, pressure;                ///< [m/s], [Pa], dynamic; no number unless thick
  Vec<3> velocity;                       ///< mean [m/s], however thin; zero where nothing is
};

/// The columns of material above the pixels of a raster at an instant: the rule by which all maps, gauges and profiles
/// are made of points.
class FlowColumns {
 public:
  struct Stretch {
    int begin, end;  ///< columns of a row that material touched; none unless begin < end
  };

  /// On the pixels of a raster, whose values are ignored; with the cosine of the ground's slope in the middle of each,
  /// and the vertical thickness above which speed is known [m].
  FlowColumns(PlanRaster pixels, std::vector<double> cosines, double least_thickness);

  /// Forgets the last instant.
  void gather(const FlowPoints& points);
  const Stretch& touched(int row) const { return touched_[std::size_t(row)]; }
  bool has_material(std::size_t pixel) const { return columns_[pixel].volume > 0; }
  ColumnFlow flow_of(std::size_t pixel) const;
  /// Of material outside the raster [m3].
  double volume_outside() const { return volume_outside_; }

 private:
  /// Sums over the material above a pixel.
  struct Column {
    double volume = 0, mass = 0, momentum_x = 0, momentum_y = 0, momentum_z = 0;
  };

  PlanRaster pixels_;  ///< without values
  std::vector<double> cosines_;
  double least_thickness_;
  std::vector<Column> columns_;   ///< 0 outside `touched_`
  std::vector<Stretch> touched_;  ///< of each row
  double volume_outside_ = 0;
};

/// Edge of the square that a point of a volume [m3] covers in plan [m]: its cube root, to 14 digits.
double width_in_plan(double volume);

/// Maps of an instant.
struct FlowMap {
  PlanRaster vertical_thickness;  ///< [m]; 0 where nothing is
  PlanRaster thickness;           ///< [m], normal to the ground; 0 where nothing is. At the end of a run: the deposit
  PlanRaster speed;               ///< [m/s]; no number where the vertical thickness does not exceed the limit
  PlanRaster pressure;            ///< [Pa], dynamic; as speed
  double volume_outside = 0;      ///< of material outside the raster [m3]
};

/// Peaks of a run and the time of arrival, from instants a stated interval apart.
class FlowMaps {
 public:
  /// On the pixels of a raster, whose values are ignored. `interval` [s] > 0 between instants; `least_thickness` [m],
  /// vertical, above which speed, pressure and arrival are known. `state` is what `state()` returned before the run was
  /// stopped; throws std::runtime_error if it belongs to other pixels.
  FlowMaps(const Terrain& ground, PlanRaster pixels, double interval, double least_thickness,
           std::span<const double> state = {});

  /// Whether an instant is one that counts, or the first after one.
  bool due(double time) const { return time >= next_ * interval_ * (1 - 1e-12); }
  /// Adds an instant that is due [s].
  void add(double time, const FlowPoints& points);
  /// Everything that decides what is to come: a resumed run has the same bits.
  std::vector<double> state() const;

  /// Maps of an instant, which is not added to the peaks.
  FlowMap now(const FlowPoints& points);

  const PlanRaster& peak_thickness() const {
    return peak_thickness_;
  }                                                                   ///< [m], normal to the ground; 0 if nothing came
  const PlanRaster& peak_speed() const { return peak_speed_; }        ///< [m/s]; no number where no flow came
  const PlanRaster& peak_pressure() const { return peak_pressure_; }  ///< [Pa]; as speed
  const PlanRaster& arrival() const { return arrival_; }              ///< [s], of the first instant that saw flow
  /// The largest volume that lay outside the raster at one instant [m3].
  double peak_volume_outside() const { return peak_volume_outside_; }

 private:
  PlanRaster peak_thickness_, peak_speed_, peak_pressure_, arrival_;
  double interval_;
  double next_ = 0;  ///< number of the instant to come
  double peak_volume_outside_ = 0;
  FlowColumns columns_;  ///< of the last instant
};

}  // namespace talus
