#pragma once
/// Initial stress of bodies.

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

/// The ground vertically above a place.
struct Load {
  double stress = 0;  ///< its weight per area, pressure positive [Pa]
  double depth = 0;   ///< its thickness [m]
};

/// Overburden of bodies that start at rest under their own weight (`k0`). All such bodies above a place count, also
/// across gaps.
class Overburden {
 public:
  explicit Overburden(const Case& case_);  // which must outlive this object

  /// Overburden of a particle of this width [m]: along the vertical line for bodies with a shape; averaged over the
  /// width for listed points, which are cubes.
  Load on(const Vec<3>& x, double width) const;

  /// Slope of the surface along x and y above a place of a body on terrain: that of the highest layer there. 0 for
  /// other bodies.
  Vec<2> slope_above(const BodySpec& body, const Vec<3>& x) const;

 private:
  /// Listed points by vertical columns as wide as the widest point.
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
    PlanRaster thickening_x{}, thickening_y{};  ///< gradient of the thickness of a layer on terrain along x and y
  };
  double across(const Vec<3>& x) const { return dim_ == 3 ? x[1] : 0; }
  double thickness(const PointList& list, const Columns& columns, const Vec<3>& x, double width) const;

  int dim_;
  std::vector<Layer> layers_;
};

/// Initial stress of a particle. With `k0` under a load [Pa]: K0 times the load horizontally, and with inclined
/// gravity, or under a surface with a `slope`, the shear stress of equilibrium. The stress is constant along a slope,
/// so the stress on planes parallel to the surface is the weight above, s.n = -load n_z e_z; this and the horizontal
/// stress K0 times the load determine the rest. Under a plane surface this is in equilibrium for any ground below.
InitialState initial_state(const Case& case_, const BodySpec& body, double load, const Vec<2>& slope = {});

/// Speed of compression waves there [m/s], or the reason why the material cannot be at rest.
std::variant<double, std::string> wave_speed_at_rest(const Case& case_, const BodySpec& body, double load);

}  // namespace talus
