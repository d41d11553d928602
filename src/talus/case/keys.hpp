#pragma once
/// Numbers of the input: key, unit, range and meaning, for readers, the schema and `resolve`.

#include <limits>

#include "talus/base/parameter.hpp"

namespace talus::keys {

// [domain]
inline constexpr Parameter cell{"cell", "m", Range::positive(), "size of the grid's cells"};
inline constexpr Parameter friction{"friction", "1", Range::not_negative(),
                                    "Coulomb's coefficient: tangent of the angle of wall friction"};

inline constexpr Parameter xi{"xi", "m/s2", Range::positive(),
                              "turbulent friction of Voellmy: shear stress rho g v^2/xi at sliding speed v"};

// [material.NAME]; parameters of laws are declared with the law
inline constexpr Parameter density{"density", "kg/m3", Range::positive(), "bulk density at the start"};

// [body.NAME]
inline constexpr Parameter spacing{"spacing", "m", Range::positive(), "distance between particles at the start"};
inline constexpr Parameter scatter{
    "scatter", "1", Range::between(0, 0.5),
    "largest random offset of particles from the lattice along each axis, as a share of the spacing"};
inline constexpr Parameter seed{"seed", "1", Range::between(0, std::numeric_limits<int>::max()),
                                "seed of the random positions of `scatter`"};
constexpr Parameter void_ratio(const Range& of_law) { return {"void_ratio", "1", of_law, "void ratio at the start"}; }

// shapes
inline constexpr Parameter radius{"radius", "m", Range::positive(), "radius"};
inline constexpr Parameter height{"height", "m", Range::positive(), "height"};
inline constexpr Parameter pixel{"pixel", "m", Range::positive(), "edge of a pixel"};

// [numerics]
inline constexpr Parameter tau{"tau", "s", Range::positive(),
                               "decay time of velocity fluctuations that the grid does not resolve"};
/// Without gravity there is no characteristic speed.
inline constexpr Parameter tau_without_default{
    "tau", "s", Range::positive(),
    "decay time of velocity fluctuations that the grid does not resolve, about 1/100 of the duration of the motion; or "
    "use "
    "transfer = \"apic\" for bodies that rotate, \"flip\" for elastic waves"};
inline constexpr Parameter flip_share{"flip_share", "1", Range::between(0, 1),
                                      "share of the particles' own velocity that is kept each step"};
inline constexpr Parameter tolerance{"tolerance", "1", Range::between(1e-12, 0.1),
                                     "relative error of a substep of the integrator"};
inline constexpr Parameter dt{"dt", "s", Range::positive(), "fixed time step; without it the step adapts"};
inline constexpr Parameter cfl{
    "cfl",
    "1",
    {0, 1, true, false},
    "largest distance that waves and particles travel in a step, as a share of the cell size"};
inline constexpr Parameter bulk_viscosity{
    "bulk_viscosity", "1", Range::between(0, 1),
    "damping of volume between neighbouring cells, as a share of critical damping, in laws whose stiffness follows "
    "the pressure"};
inline constexpr Parameter shifting_length{"shifting_length", "m", Range::positive(),
                                           "length that sets how fast particle shifting spreads a crowd, at most four "
                                           "cells; the same length on all cells corrects as much"};
inline constexpr Parameter rest_tolerance{
    "rest_tolerance", "1", Range::between(0, 0.1),
    "displacement in cells, in the time sqrt(h/g), below which material is at rest and left out of steps until it is "
    "pushed; 0: all material is in every step"};
inline constexpr Parameter stiffness_factor{
    "stiffness_factor",
    "1",
    {0, 1, true, false},
    "factor on the elastic stiffness of every material: below 1 time steps are longer and waves slower"};

// [run]
inline constexpr Parameter end{"end", "s", Range::positive(), "simulated time at which the run ends"};

inline constexpr Parameter stop_below{
    "stop_below",
    "1",
    {0, 1, true, false},
    "the run ends when the kinetic energy falls below this share of its largest value; without it, at `end`"};

// [output]
inline constexpr Parameter snapshots{"snapshots", "s", Range::positive(), "time between snapshots"};
inline constexpr Parameter history{"history", "s", Range::positive(), "time between rows of history.csv"};
inline constexpr Parameter front_thickness{"front_thickness", "m", Range::positive(),
                                           "thickness that defines the edge of the deposit"};
inline constexpr Parameter peak_force_time{
    "peak_force_time", "s", Range::positive(),
    "time over which the force on a wall or solid is averaged before its peak is taken"};
// [output.maps]
inline constexpr Parameter map_interval{"interval", "s", Range::positive(),
                                        "time between the instants of which maps take peaks"};
inline constexpr Parameter least_thickness{
    "least_thickness", "m", Range::positive(),
    "vertical thickness above which material counts as flow, for maps of speed and arrival"};
inline constexpr Parameter map_pixel{"pixel", "m", Range::positive(), "edge of the maps' pixels"};
inline constexpr Parameter map_frames{"frames", "s", Range::positive(),
                                      "time between the maps of thickness and speed in the report"};
// [thalweg]
inline constexpr Parameter thalweg_width{"width", "m", Range::positive(),
                                         "width of the strip in which flow counts, half of it on either side"};
/// Permitted range for a run until `end`; without limit if its length is not known.
constexpr Parameter pictures(double run_end) {
  return {"pictures", "s", run_end > 0 ? Range::between(0, run_end) : Range::not_negative(),
          "instants of the pictures"};
}
inline constexpr Parameter checkpoints{"checkpoints", "s", Range::positive(),
                                       "simulated time between checkpoints, in addition to those by the clock"};
inline constexpr Parameter checkpoint_wall{"checkpoint_wall", "s", Range::positive(),
                                           "time on the clock between checkpoints"};

}  // namespace talus::keys
