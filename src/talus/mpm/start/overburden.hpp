#pragma once
/// What a body is like before the first step.

#include <array>
#include <cmath>
#include <map>
#include <string>
#include <variant>
#include <vector>

#include "talus/case/case.hpp"

namespace talus {

/// Bulk density of a body at the start [kg/m3].
double bulk_density(const Material& material, const BodySpec& body);

/// The ground that lies straight above a place and rests on it.
struct Load {
  double stress = 0;  ///< its weight per area, pressure positive [Pa]
  double depth = 0;   ///< its thickness [m]
};

/// What bodies that start at rest under their own weight, `k0`, bear down with. All of them that lie above a place count,
/// whatever is between.
class Overburden {
 public:
  explicit Overburden(const Case& case_);  // which must stay where it is

  /// On a particle so wide [m]. Of bodies with a shape what the vertical line through it has of them, of listed points,
  /// which are cubes, the mean over its width.
  Load on(const Vec<3>& x, double width) const;

  /// How the surface above a place of a body that lies on ground slopes along x and y: that of the highest layer there.
  /// 0 for other bodies, which have no slope.
  Vec<2> slope_above(const BodySpec& body, const Vec<3>& x) const;

 private:
  /// Listed points by columns of the ground, as wide as the widest of them.
  struct Columns {
    double width = 0;  ///< [m]
    std::map<std::array<int, 2>, std::vector<std::size_t>> points;
    std::array<int, 2> column_of(double x, double y) const {
      return {int(std::floor(x / width)), int(std::floor(y / width))};
    }
  };
  struct Layer {
    const Region* region;
    double weight;  ///< per volume [N/m3]
    Columns columns;
    PlanRaster thickening_x{}, thickening_y{};  ///< of a layer on ground: how its thickness grows along x and y
  };
  double across(const Vec<3>& x) const { return dim_ == 3 ? x[1] : 0; }
  double thickness(const PointList& list, const Columns& columns, const Vec<3>& x, double width) const;

  int dim_;
  std::vector<Layer> layers_;
};

/// What a particle starts from. With `k0` under a load [Pa]: K0 times it across, and where gravity leans, or under a
/// surface of some `slope`, the shear stress that holds it. Along a slope nothing changes, so that the stress on planes
/// parallel to the surface is the weight above, s.n = -load n_z e_z; horizontal stress K0 times the load and this give the
/// rest. Under a plane surface that is balance everywhere, whatever the ground below is like.
InitialState initial_state(const Case& case_, const BodySpec& body, double load, const Vec<2>& slope = {});

/// Speed of compression waves there [m/s]; or why nothing can rest there.
std::variant<double, std::string> wave_speed_at_rest(const Case& case_, const BodySpec& body, double load);

}  // namespace talus
