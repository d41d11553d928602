#pragma once
/// Description of a run by the user, as plain data in SI units.
///
/// A std::optional member with the remark "by default" is computed from the rest of the case if the user does not set
/// it: `resolve` fills it in (case/resolve.hpp), so it has a value in the solver and the output.

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "talus/base/parameter.hpp"
#include "talus/geometry/solid.hpp"
#include "talus/law/registry.hpp"

namespace talus {

enum class Preset { standard, paper };
inline constexpr Choice preset_choices[] = {
    {"standard", "every key has the default that talus recommends"},
    {"paper",
     "the paper's scheme as printed: linear, flip, usf, forward_euler, dt = 1 us, collisional_form rate, no averaging"},
};

enum class ShapeFunction { quadratic, linear, cubic, ugimp };
inline constexpr Choice shape_function_choices[] = {
    {"quadratic", "quadratic B-spline, three nodes per axis"},
    {"linear", "hat function, two nodes per axis; stress is noisy where points cross cells"},
    {"cubic", "cubic B-spline, four nodes per axis; smoothest stress, longest steps, most work per step"},
    {"ugimp", "hat function averaged over a particle as wide as `spacing` (Bardenhagen and Kober 2004)"},
};

enum class Transfer { affine_tau, flip_tau, flip, apic, tpic };
inline constexpr Choice transfer_choices[] = {
    {"affine_tau",
     "FLIP; velocity fluctuations that are not locally affine decay with time constant tau; independent of the time "
     "step"},
    {"flip_tau",
     "FLIP; all velocity fluctuations below the cell size decay with time constant tau; acts like a viscosity h^2/(4 "
     "tau)"},
    {"flip",
     "FLIP that keeps the share `flip_share` of fluctuations per step (0: PIC); below 1 it depends on the time step"},
    {"apic", "affine PIC (Jiang et al. 2015): conserves angular momentum; the result depends on the time step"},
    {"tpic", "Taylor PIC: particles carry their velocity gradient; the result depends on the time step"},
};

enum class Order { usf, musl };
inline constexpr Choice order_choices[] = {
    {"usf", "stress update first, from node velocities at the start of the step (the paper's order)"},
    {"musl", "stress update last, from new particle velocities mapped to the nodes (Sulsky et al. 1995)"},
};

enum class Splitting { across_motion, all_directions, none };
inline constexpr Choice splitting_choices[] = {
    {"across_motion",
     "split particles that flow where cells beside their way would run empty, and merge alike ones where they crowd"},
    {"all_directions",
     "the same, also along their motion: no gaps in thin layers, but their fronts reach up to 10 % farther"},
    {"none", "the number of particles does not change"},
};

enum class InitialStress { k0, zero, given };
inline constexpr Choice initial_stress_choices[] = {
    {"k0",
     "at rest under its own weight and that of `k0` bodies above: vertical the sum of rho g z, "
     "horizontal K0 times that, K0 = 1 - sin(friction angle) (Jaky 1944)"},
    {"zero", "none"},
};  // `given` has no name in a file: there it is a table of components

enum class Lattice { cells, corner, blue_noise };
inline constexpr Choice lattice_choices[] = {
    {"cells", "points in the middle of cubes of size `spacing`, counted from the corner of the bounding box"},
    {"corner", "points at whole multiples of `spacing` from that corner, the corner included"},
    {"blue_noise",
     "no rows: one random point in each of the cubes of `cells`, as far as possible from its neighbours (Mitchell "
     "1991)"},
};

/// Quantities that every particle has, whatever its law.
inline constexpr Quantity common_quantities[] = {
    {"velocity", "m/s", 3, "velocity of the material"},
    {"body", "1", 1, "number of the body, in the order of the case"},
    {"id", "1", 1, "number of the particle, from 0"},
    {"ancestor", "1", 1, "id of the initial particle from which it was split"},
    {"mass", "kg", 1, "mass; in plane strain per metre of thickness, axisymmetric per radian"},
    {"volume", "m3", 1, "volume; in plane strain per metre of thickness, axisymmetric per radian"},
    {"stress", "Pa", 6, "total Cauchy stress, tension-positive"},
    {"p", "Pa", 1, "mean pressure of the total stress"},
    {"q", "Pa", 1, "von Mises stress of the total stress"},
    {"shear_rate", "1/s", 1, "|g| = sqrt(D:D/2) of the strain rate's deviator D"},
    {"spin", "kg m2/s", 3, "angular momentum about the position of the particle; only with transfer apic"},
};
struct Material {
  std::string name;
  AnyLaw law;
  double density = 0;  ///< bulk density [kg/m3]; for granular materials it follows from rho_s and the void ratio

  /// Whether names, densities and the parameters and options of the laws are the same.
  bool operator==(const Material& other) const;
};

/// The map that a case lies on.
struct MapOfCase {
  std::shared_ptr<const Terrain> ground;  ///< of the solid `terrain`
  MapFrame frame;
  bool geotiff = false;  ///< format of the terrain and of the maps: GeoTIFF; otherwise ESRI ASCII

  bool operator==(const MapOfCase& o) const {
    return same_content(ground, o.ground) && frame == o.frame && geotiff == o.geotiff;
  }
};

struct BodySpec {
  std::string name;
  int material = 0;  ///< index into Case::materials
  Region region;
  double spacing = 0;  ///< of the points [m]
  Lattice lattice = Lattice::cells;
  std::optional<double> void_ratio;
  InitialStress initial_stress = InitialStress::zero;
  SymTensor<double> given_stress = SymTensor<double>::zero();  ///< [Pa], tension-positive, if `given`
  double scatter = 0;         ///< largest random offset of points from the lattice along each axis, over the spacing
  int seed = 1;               ///< of the scatter, or of blue noise
  Vec<3> velocity{};          ///< of its centre of mass [m/s]
  Vec<3> angular_velocity{};  ///< about its centre of mass [rad/s]; in 2D the third component, positive from x to y

  bool operator==(const BodySpec&) const = default;
};

inline constexpr Choice side_choices[] = {
    {"x_min", "where x is least"},   {"x_max", "where x is largest"}, {"y_min", "where y is least"},
    {"y_max", "where y is largest"}, {"z_min", "where z is least"},   {"z_max", "where z is largest"},
};

/// A stress on one side of a body, with the area and direction of the start (dead load).
struct SurfaceLoad {
  std::string name;
  int body = 0;                 ///< index into Case::bodies
  int side = 0;                 ///< index into `side_choices`
  Vec<3> traction{};            ///< force per area on the body [Pa]
  LinearInTime<double> factor;  ///< factor on the traction; 1 if empty
  std::optional<Box> within{};  ///< only this part of the side [m]

  /// Traction at an instant [Pa].
  Vec<3> at(double time) const { return factor.empty() ? traction : factor.at(time) * traction; }
  bool operator==(const SurfaceLoad&) const = default;
};

/// Traction of a pressure on a side [Pa], normal to the side and into the body.
inline Vec<3> traction_of_pressure(int side, double pressure) {
  Vec<3> traction{};
  traction[side / 2] = (side % 2 == 0 ? 1 : -1) * pressure;
  return traction;
}

/// The defaults here are those of the preset `standard`; `numerics_of` in case/defaults.hpp has those of the others.
struct Numerics {
  Preset preset = Preset::standard;  ///< determines the defaults of the other members
  ShapeFunction shape_function = ShapeFunction::quadratic;
  Transfer transfer = Transfer::affine_tau;
  std::optional<double> tau;  ///< [s], of transfers that have one (`has_tau`); by default from the height of the bodies
  double flip_share = 1;      ///< of `flip`
  Order order = Order::usf;
  bool average_pressure = true;
  bool particle_shifting = true;
  std::optional<double> shifting_length;                    ///< of `particle_shifting` [m]; by default a cell
  Splitting particle_splitting = Splitting::across_motion;  ///< of materials that flow; and merging
  /// Displacement in cells, in the time sqrt(h/g), below which material rests and is left out of steps; 0: none is.
  double rest_tolerance = 0;
  bool f_bar = false;  ///< only the rate of volume change is averaged over cells; not with `average_pressure`
  std::optional<double> bulk_viscosity;  ///< share of critical damping; by default from preset and order
  Integration integration{Integrator::return_mapping, 1e-3};
  /// Courant number: share of a cell that waves and particles may cross in a step; by default that of shape and laws.
  std::optional<double> cfl;
  /// Factor on the elastic stiffness of every material: softer material permits longer steps.
  double stiffness_factor = 1;
  std::optional<double> dt;  ///< fixed step [s]; without it the step adapts

  bool operator==(const Numerics&) const = default;
};

/// Maps of a run on a terrain.
struct MapSpec {
  std::optional<double> interval;  ///< between instants at which peaks are updated [s]; by default from the terrain
  std::optional<double>
      least_thickness;  ///< vertical thickness above which material counts as flow [m]; by default from the particles
  std::optional<double> pixel;   ///< [m]; by default that of the terrain
  std::optional<double> frames;  ///< between instants of the map in the report [s]; by default a share of the run

  bool operator==(const MapSpec&) const = default;
};

/// Place, or line across the flow, at which flow over a terrain is measured.
struct Gauge {
  std::string name;
  /// In coordinates of the run [m]: one point is a place, several are a line. Flow is positive from right to left, as
  /// seen from the first point to the last: downstream if the line begins on the left bank.
  std::vector<Vec<2>> points;

  bool is_line() const { return points.size() > 1; }
  bool operator==(const Gauge&) const = default;
};

/// The line down a slope along which runout is measured.
struct Thalweg {
  std::vector<Vec<2>> points;  ///< in coordinates of the run [m]; two or more, the first where the ground is higher
  double width = 0;            ///< width of the strip around the line that is evaluated, half on either side [m]

  bool operator==(const Thalweg&) const = default;
};

enum class ReportSize { small, full };
inline constexpr Choice report_choices[] = {
    {"small", "at most 8 MB: snapshots and particles are left out of the page if necessary"},
    {"full", "everything; browsers open pages beyond 100 MB slowly or not at all"},
};

struct OutputSpec {
  std::optional<double> snapshots;        ///< interval [s]; by default a share of the run
  std::optional<double> history;          ///< interval [s]; by default a share of the run
  std::optional<double> peak_force_time;  ///< averaging time of peak forces [s]; by default from the height of fall
  std::optional<double> front_thickness;  ///< that defines the edge of the deposit [m]; by default a grain
  std::optional<std::vector<double>> pictures;     ///< instants [s]; by default from the start to the end
  std::optional<std::vector<std::string>> fields;  ///< quantities in snapshots; by default those that the laws have
  MapSpec maps{};
  std::optional<double> checkpoints;      ///< interval of simulated time [s]; without it, by the clock alone
  double checkpoint_wall = 600;           ///< interval on the clock [s]
  ReportSize report = ReportSize::small;  ///< of report.html

  bool operator==(const OutputSpec&) const = default;
};

inline std::string_view word_of(Transfer transfer) { return transfer_choices[int(transfer)].word; }

/// Whether particles store the variation of velocity around them.
inline bool is_affine(Transfer transfer) { return transfer == Transfer::apic || transfer == Transfer::tpic; }

/// Whether sub-grid velocity decays at a rate.
inline bool has_tau(Transfer transfer) { return transfer == Transfer::flip_tau || transfer == Transfer::affine_tau; }

/// Whether particles lose a share of their velocity in every step, independent of its length, so that the result
/// depends on the step.
inline bool depends_on_step(const Numerics& n) {
  return is_affine(n.transfer) || (n.transfer == Transfer::flip && n.flip_share < 1);
}

/// A run of the material point method.
struct Case {
  std::string title;
  int dim = 2;                ///< 2: plane strain, x and y, y upwards as gravity has it; 3: x, y, z
  bool axisymmetric = false;  ///< with dim = 2: x is the radius; extensive quantities are per radian
  Box domain{};
  double cell = 0;     ///< size of the grid's cells [m]
  Index<3> n_cells{};  ///< set by `resolve`
  Vec<3> gravity{};
  std::array<Wall, 6> walls{};  ///< low and high side of x, of y, of z
  std::vector<Solid> solids;
  std::optional<MapOfCase> map;
  std::vector<Material> materials;
  std::vector<BodySpec> bodies;
  std::vector<SurfaceLoad> loads;
  Numerics numerics;
  double end = 0;         ///< [s]
  double stop_below = 0;  ///< the run ends when the kinetic energy falls below this share of its peak; 0: no such end
  OutputSpec output;
  std::vector<Gauge> gauges;       ///< of a run on terrain
  std::optional<Thalweg> thalweg;  ///< likewise

  bool operator==(const Case&) const = default;
};

/// Whether particles may leave through a side.
inline bool has_outflow(const Case& case_) {
  return std::any_of(case_.walls.begin(), case_.walls.end(),
                     [](const Wall& wall) { return wall.kind == WallKind::outflow; });
}

/// The half spaces in front of the planes of symmetry; unbounded along axes without such a plane.
inline Box kept_by_symmetry(const Case& case_) {
  constexpr double infinity = std::numeric_limits<double>::infinity();
  Box kept{{-infinity, -infinity, -infinity}, {infinity, infinity, infinity}};
  for (int a = 0; a < case_.dim; ++a) {
    if (case_.walls[2 * a].kind == WallKind::symmetry) kept.min[a] = case_.domain.min[a];
    if (case_.walls[2 * a + 1].kind == WallKind::symmetry) kept.max[a] = case_.domain.max[a];
  }
  return kept;
}

/// Width of a particle at the start [m]: the spacing, or for listed points from their volume.
inline double width_at_start(const BodySpec& body, double volume, int dim) {
  return body.spacing > 0 ? body.spacing : std::pow(volume, 1.0 / dim);
}

/// The longest side of the domain [m].
inline double extent(const Case& case_) {
  double most = 0;
  for (int a = 0; a < case_.dim; ++a) most = std::max(most, case_.domain.max[a] - case_.domain.min[a]);
  return most;
}

}  // namespace talus
