#pragma once
/// Forces of the material on walls and solids, and the heat of friction on each of them.

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/mpm/surface_accounts.hpp"

namespace talus {

/// A solid, the terrain, or a side of the domain that is a wall.
struct NamedSurface {
  std::string name;           ///< in names of columns: `solid_gate`, `terrain`, `wall_x_max`
  std::string label;          ///< in words
  std::vector<int> accounts;  ///< its own, then those of its zones
  bool is_solid = false;
  bool rubs = false;  ///< it has friction
};

/// A zone of a terrain.
struct NamedZone {
  std::string name, label;
  int account;
};

/// All surfaces of a case that forces are computed for: solids in their order, then walls.
std::vector<NamedSurface> surfaces_of(const Case& case_);
std::vector<NamedZone> zones_of(const Case& case_);

/// The force of the material on a surface [N]; in plane strain per metre of thickness, axisymmetric per radian.
struct SurfaceForce {
  Vec<3> total{}, normal{};  ///< the resultant, and the part of it along the normals of the surface
  double time = 0;           ///< middle of the interval that it is the mean of [s]
  Vec<3> tangential() const { return total - normal; }
};

/// What the record and the report say of the surfaces of a run.
struct SurfaceSummary {
  struct OfSurface {
    std::string name, label;
    Vec<3> impulse;                         ///< that the material has given to it [N s]
    std::optional<SurfaceForce> peak, end;  ///< none if the run is shorter than the averaging time
    std::optional<double> friction;         ///< heat [J]; none where there is none
  };
  struct OfZone {
    std::string name, label;
    double friction;  ///< heat [J]
  };
  double averaged_over = 0;  ///< averaging time of `peak` and `end` [s]
  std::vector<OfSurface> surfaces;
  std::vector<OfZone> zones;
  std::optional<double> turbulent;  ///< heat of turbulent friction [J]; none without `voellmy`
};

/// Follows the impulses that surfaces have given, step by step. A force is an impulse over a time, so that means over
/// rows of history.csv add up to what the momentum balance holds; the force of a single step is dominated by elastic waves.
class SurfaceForces {
 public:
  /// `state`: what `state` returned when the run stopped; empty for a new run.
  explicit SurfaceForces(const Case& case_, const std::vector<double>& state = {});

  /// The columns of history.csv, with units.
  static std::vector<std::string> columns(const Case& case_);

  /// Takes over the accounts at an instant; to be called after every step.
  void follow(double time, const std::vector<SurfaceAccount>& accounts);
  /// Values of the columns: mean forces since the last row, 0 in the first, and friction since the start.
  std::vector<double> row();
  SurfaceSummary summary() const;
  std::vector<double> state() const;

 private:
  /// Peaks are means over so many parts of the averaging time, one part further each time.
  static constexpr int n_parts = 4;

  /// Impulses that the material has given [N s], and their moment [N m s].
  struct Given {
    Vec<3> impulse{}, normal{}, moment{};
  };
  struct Track {
    Given now{}, at_row{};
    std::array<Given, n_parts + 1> samples{};  ///< at the last ends of parts, by their number modulo n_parts + 1
    SurfaceForce peak{};
  };
  struct Clock {
    double now = 0, at_row = 0;  ///< [s]
    double n_parts_done = 0;
  };

  Given given_by(const NamedSurface& surface) const;
  void finish_parts(double time, const std::vector<Given>& next);
  SurfaceForce mean_of_last_parts(const Track& track) const;

  int dim_;
  bool axisymmetric_;
  double averaged_over_;
  std::vector<NamedSurface> surfaces_;
  std::vector<NamedZone> zones_;
  bool turbulent_;
  std::vector<Track> tracks_;  ///< one a surface
  Clock clock_;
  std::vector<SurfaceAccount> accounts_;  ///< as they are now
};

}  // namespace talus
