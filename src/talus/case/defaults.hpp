#pragma once
/// Defaults that follow from the rest of a case, each with its reason. `resolve` fills them in, and readers show them.

#include <optional>
#include <string_view>
#include <vector>

#include "talus/case/case.hpp"

namespace talus {

/// A number that holds unless the user gives another, and why.
struct Default {
  double value;
  std::string_view reason;
};

/// The numerics of a preset before the user changes any of them.
Numerics numerics_of(Preset preset);

/// Whether the elastic compression is averaged: unless the rate of volume change is averaged already.
bool averages_pressure(Preset preset, bool f_bar);

/// Bulk viscosity of a run, as a share of critical damping.
Default default_bulk_viscosity(Preset preset, Order order);
/// That of a case, whether its user gave it or not.
double bulk_viscosity_of(const Numerics& numerics);

/// The number of the choice that an option of a law has under a preset.
/// `confined`: of a sample whose stress is controlled. What presses on it keeps its grains together, so they collide also
/// when they lose contact; material with a free surface is thrown off instead.
int default_choice(const Option& option, Preset preset, bool confined = false);

/// A law with the options of a preset; its parameters are still to be set.
template <class Law>
Law law_of(Preset preset) {
  Law law{};
  for (const auto& option : Law::options()) option.set(law, default_choice(option, preset));
  return law;
}

/// The largest share of a cell that waves and particles may cross in a step.
Default default_cfl(ShapeFunction shape);
/// That of a case, whether its user gave it or not.
double cfl_of(const Numerics& numerics);

/// Time constant of the decay of velocity fluctuations [s]; none where nothing falls.
std::optional<Default> default_tau(const Case& case_);

/// The surface of a side of the domain, or of a solid. Material lifts off a rubbing surface; off a smooth one it lifts if
/// that is a solid's, while a smooth wall is a plane of symmetry as often as not.
bool separates_from_wall(WallKind kind);
bool separates_from_solid(WallKind kind);
inline Wall wall_of_domain(WallKind kind, double friction = 0) { return {kind, friction, separates_from_wall(kind)}; }
inline Wall surface_of_solid(WallKind kind, double friction = 0) {
  return {kind, friction, separates_from_solid(kind)};
}

/// Friction of a `rough` surface: that of the first material that has a critical friction; 0 if none has. And how it grows
/// with the rate there.
double rough_friction(const Case& case_);
FrictionRise rough_friction_rise(const Case& case_);

/// In which things fall by half the height of all bodies, sqrt(H/g) [s]; 0 where nothing falls.
double time_of_fall(const Case& case_);

/// Of the maps of a run on terrain.
Default default_map_interval(const Case& case_);
Default default_least_thickness(const Case& case_);
Default default_map_pixel(const Case& case_);
Default default_map_frames(const Case& case_);

Default default_snapshots(const Case& case_);  ///< interval [s]
Default default_history(const Case& case_);    ///< interval [s]
/// Time over which a force is averaged before its peak is taken [s]: a tenth of that in which what falls comes down, so
/// that elastic waves are averaged out and an impact is not.
Default default_peak_force_time(const Case& case_);
/// Thickness that defines the edge of the deposit [m]: no layer of grains is thinner than a grain, and experiments see
/// none. Of a law that does not know its grains, a layer of particles.
Default default_front_thickness(const Case& case_);
std::vector<double> default_pictures(const Case& case_);  ///< instants [s]

/// Quantities that snapshots may hold, and those they hold by default; where particles may leave, `id` too.
std::vector<std::string_view> known_fields(const Case& case_);
std::vector<std::string> default_fields(const Case& case_);

/// Edge of a body's largest particle at the start [m].
double largest_particle(const BodySpec& body, int dim);

}  // namespace talus
