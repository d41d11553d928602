#pragma once
/// Defaults computed from the rest of a case, each with its reason. `resolve` fills them in, readers print them.

#include <optional>
#include <string_view>
#include <vector>

#include "talus/case/case.hpp"

namespace talus {

/// A default value and its reason.
struct Default {
  double value;
  std::string_view reason;
};

/// The numerics of a preset.
Numerics numerics_of(Preset preset);

/// Default of `average_pressure`: true unless the rate of volume change is averaged (`f_bar`).
bool averages_pressure(Preset preset, bool f_bar);

/// Bulk viscosity of a run, as a share of critical damping.
Default default_bulk_viscosity(Preset preset, Order order);
/// The value of a case: that of the user, or the default.
double bulk_viscosity_of(const Numerics& numerics);

/// Number of the default choice of an option of a law under a preset. `confined`: the stress of the sample is
/// controlled. The load then holds the grains together, so they collide also after they lose contact; material at a
/// free surface would fly off.
int default_choice(const Option& option, Preset preset, bool confined = false);

/// A law with the options of a preset; its parameters are still to be set.
template <class Law>
Law law_of(Preset preset) {
  Law law{};
  for (const auto& option : Law::options()) option.set(law, default_choice(option, preset));
  return law;
}

/// Default Courant number: share of a cell that waves and particles may cross in a step. Larger where the stiffness of all
/// materials vanishes with their stress.
Default default_cfl(const Case& case_);
/// The value of a case: that of the user, or the default that suits any material.
double cfl_of(const Numerics& numerics);

/// Time constant of the decay of velocity fluctuations [s]; none without gravity.
std::optional<Default> default_tau(const Case& case_);

/// Surface of a side of the domain or of a solid, with the default of `separates`. Material may separate from surfaces
/// with friction and from smooth solids; it stays on smooth walls, which often represent a symmetric continuation.
bool separates_from_wall(WallKind kind);
bool separates_from_solid(WallKind kind);
inline Wall wall_of_domain(WallKind kind, double friction = 0) { return {kind, friction, separates_from_wall(kind)}; }
inline Wall surface_of_solid(WallKind kind, double friction = 0) {
  return {kind, friction, separates_from_solid(kind)};
}

/// Friction of a `rough` surface: that of the first material with a critical friction; 0 if there is none. And its
/// increase with the rate.
double rough_friction(const Case& case_);
FrictionRise rough_friction_rise(const Case& case_);

/// Time of free fall over half the height H of all bodies, sqrt(H/g) [s]; 0 without gravity.
double time_of_fall(const Case& case_);

/// Defaults of the maps of a run on terrain.
Default default_map_interval(const Case& case_);
Default default_least_thickness(const Case& case_);
Default default_map_pixel(const Case& case_);
Default default_map_frames(const Case& case_);

Default default_snapshots(const Case& case_);  ///< interval [s]
Default default_history(const Case& case_);    ///< interval [s]
/// Averaging time of peak forces [s]: a tenth of the time of free fall, which averages over elastic waves but not over
/// an impact.
Default default_peak_force_time(const Case& case_);
/// Thickness that defines the edge of the deposit [m]: the largest grain diameter, because no layer of grains is
/// thinner; for laws without a grain diameter, the particle spacing.
Default default_front_thickness(const Case& case_);
std::vector<double> default_pictures(const Case& case_);  ///< instants [s]

/// Quantities that snapshots may have, and their default; with outflow also `id`.
std::vector<std::string_view> known_fields(const Case& case_);
std::vector<std::string> default_fields(const Case& case_);

/// Edge of a body's largest particle at the start [m].
double largest_particle(const BodySpec& body, int dim);

}  // namespace talus
