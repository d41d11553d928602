#pragma once
/// What the user asks for: a run, as plain data in SI units.

#include <array>
#include <limits>
#include <optional>
#include <string>
#include <vector>

#include "talus/base/parameter.hpp"
#include "talus/case/solid.hpp"
#include "talus/law/registry.hpp"

namespace talus {

enum class ShapeFunction { quadratic, linear };
inline constexpr Choice shape_function_choices[] = {
    {"quadratic", "quadratic B-spline, three nodes an axis"},
    {"linear", "hat function, two nodes an axis; stress is noisy where points cross cells"},
};

enum class Transfer { flip_tau, flip };
inline constexpr Choice transfer_choices[] = {
    {"flip_tau", "FLIP that forgets sub-grid velocity at a rate 1/tau: the result does not depend on the time step"},
    {"flip", "FLIP with a fixed share `flip_share` a step; below 1 the result depends on the time step"},
};

enum class InitialStress { k0, zero };
inline constexpr Choice initial_stress_choices[] = {
    {"k0",
     "at rest under its own weight: vertical rho g z, horizontal K0 = 1 - sin(friction angle) times that (Jaky 1944)"},
    {"zero", "none"},
};

enum class Lattice { cells, corner };
inline constexpr Choice lattice_choices[] = {
    {"cells", "points in the middle of cubes of size `spacing`, counted from the corner of the bounding box"},
    {"corner", "points at whole multiples of `spacing` from that corner, the corner included"},
};

/// Quantities that are told of every particle, whatever its law.
inline constexpr Quantity common_quantities[] = {
    {"velocity", "m/s", 3, "velocity"},
    {"body", "1", 1, "number of the body, in the order of the case"},
    {"mass", "kg", 1, "mass; in plane strain per metre of thickness"},
    {"volume", "m3", 1, "volume; in plane strain per metre of thickness"},
    {"stress", "Pa", 6, "total Cauchy stress, tension-positive"},
    {"p", "Pa", 1, "mean pressure of the total stress"},
    {"q", "Pa", 1, "von Mises stress of the total stress"},
    {"shear_rate", "1/s", 1, "|g| = sqrt(D:D/2) of the strain rate's deviator D"},
};
/// What snapshots hold if the user does not say otherwise.
inline constexpr std::string_view usual_fields[] = {
    "velocity", "body", "frictional_stress", "collisional_stress", "stress", "p", "q", "p_f", "void_ratio",
    "kappa",    "I",    "viscosity",         "separated"};

struct Material {
  std::string name;
  AnyLaw law;
  double density = 0;  ///< bulk density [kg/m3]; for granular materials it follows from rho_s and the void ratio
};

struct BodySpec {
  std::string name;
  int material = 0;  ///< index into Case::materials
  Region region;
  double spacing = 0;  ///< of the points [m]
  Lattice lattice = Lattice::cells;
  std::optional<double> void_ratio;
  InitialStress initial_stress = InitialStress::zero;
  Vec<3> velocity{};
};

struct Numerics {
  ShapeFunction shape_function = ShapeFunction::quadratic;
  Transfer transfer = Transfer::flip_tau;
  double tau = 0;         ///< [s]
  double flip_share = 1;  ///< of `flip`
  bool average_pressure = true;
  Integration integration;
  double cfl = 0.65;
  /// Multiplies the elastic stiffness of every material: softer ground lets the steps be longer.
  double stiffness_factor = 1;
  std::optional<double> dt;  ///< fixed step [s]; without it the step adapts
};

struct OutputSpec {
  double snapshots = 0;               ///< interval [s]
  double history = 0;                 ///< interval [s]
  std::vector<double> pictures;       ///< instants [s]
  std::vector<std::string> fields;    ///< quantities in snapshots
  std::optional<double> checkpoints;  ///< interval of simulated time [s]
  double checkpoint_wall = 600;       ///< interval on the clock [s]
};

/// A run of the material point method.
struct Case {
  std::string title;
  int dim = 2;  ///< 2: plane strain, x and y, y upwards as gravity has it; 3: x, y, z
  Box domain{};
  double cell = 0;  ///< size of the grid's cells [m]
  Index<3> n_cells{};
  Vec<3> gravity{};
  std::array<Wall, 6> walls{};  ///< low and high side of x, of y, of z
  std::vector<Solid> solids;
  std::vector<Material> materials;
  std::vector<BodySpec> bodies;
  Numerics numerics;
  double end = 0;  ///< [s]
  OutputSpec output;
};

}  // namespace talus
