#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "talus/base/units.hpp"
#include "talus/case/check.hpp"
#include "talus/case/material.hpp"

namespace talus {

namespace {

/// Least thickness of a solid in cells, so that it contains two planes of nodes. A particle touches nodes up to 1.5
/// cells away; through a single plane it would move by its own mass on the other side.
constexpr double least_thickness = 1;

/// Largest number of rows or snapshots of a run.
constexpr double most_instants = 1e6;

bool is_zero(const Vec<3>& direction) { return dot(direction, direction) == 0; }

void check_interval(MistakesOf output, std::string_view key, double interval, double end) {
  if (!(end > 0 && interval > 0)) return;
  if (interval > end)
    output.add(key, fmt::format("is longer than the run, {}", with_unit(end, "s")));
  else if (end / interval > most_instants)
    output.add(key, fmt::format("makes {:.3g} instants; at most {:.0e} are possible", end / interval, most_instants));
}

}  // namespace

void check_solids(const Case& case_, std::vector<Mistake>& mistakes) {
  for (const Solid& solid : case_.solids) {
    MistakesOf section(mistakes, section_of(solid));
    if (const auto* half = std::get_if<HalfSpace>(&solid.shape); half && is_zero(half->normal))
      section.in("half_space").add("normal", "must not be zero");
    if (!solid.motion.angle.empty()) {
      if (is_zero(solid.motion.axis)) section.in("motion").in("rotation").add("axis", "must not be zero");
      if (case_.axisymmetric)
        section.in("motion").add("rotation", "is not for axisymmetric cases: nothing moves around the axis");
    }
    const double thin = thickness(solid, case_.dim), least = least_thickness * case_.cell;
    if (thin > 0 && thin < least * (1 - 1e-9))
      section.add(fmt::format("is {} thick; it must be as thick as the cells at least, {}, or material leaks through",
                              with_unit(thin, "m"), with_unit(least, "m")));
  }
}

void check_numerics(const Case& case_, std::vector<Mistake>& mistakes) {
  MistakesOf section(mistakes, {"numerics"});
  const Numerics& n = case_.numerics;
  if (is_affine(n.transfer) && n.shape_function == ShapeFunction::linear)
    section.add("transfer",
                "needs a smoother shape: with hat functions, nodes with almost no mass get unbounded velocities; use "
                "shape = \"quadratic\", or a transfer that is not affine");
  if (n.f_bar && n.average_pressure)
    section.add("average_pressure", "must be false with `f_bar`: it averages the rate of volume change as well");
  if (n.order == Order::musl && n.bulk_viscosity.value_or(0) > 0)
    section.add("bulk_viscosity",
                "must be 0 with order = \"musl\": forces are of stresses a step old, which cannot damp");
  if (n.shifting_length && !n.particle_shifting)
    section.add("shifting_length", "has no effect without `particle_shifting`");
  else if (const double most = 4 * case_.cell; n.shifting_length.value_or(0) > most * (1 + 1e-9))
    section.add("shifting_length",
                fmt::format("must be four cells at most, {}, or shifting overshoots", with_unit(most, "m")));
  if (n.rest_tolerance > 0) {
    if (n.order == Order::musl)
      section.add("rest_tolerance", "must be 0 with order = \"musl\", which leaves nothing out");
    if (case_.gravity == Vec<3>{})
      section.add("rest_tolerance", "must be 0 without gravity, which sets the speed below which material rests");
    if (std::ranges::any_of(case_.solids, [](const Solid& s) { return !s.motion.rests(); }))
      section.add("rest_tolerance",
                  "must be 0 with solids that move: material that is left out would let them through");
  }
  if (n.stiffness_factor == 1) return;
  for (const Material& m : case_.materials)
    if (!scales_stiffness(m.law))
      section.add("stiffness_factor",
                  fmt::format("must be 1: law `{}` of material `{}` has no elastic stiffness to scale", name_of(m.law),
                              m.name));
}

void check_output(const Case& case_, std::vector<Mistake>& mistakes) {
  MistakesOf section(mistakes, {"output"});
  const OutputSpec& o = case_.output;
  check_interval(section, "snapshots", *o.snapshots, case_.end);
  check_interval(section, "history", *o.history, case_.end);
  if (case_.end > 0 && *o.peak_force_time > case_.end)
    section.add("peak_force_time", fmt::format("is longer than the run, {}", with_unit(case_.end, "s")));
  if (o.maps.frames) check_interval(section.in("maps"), "frames", *o.maps.frames, case_.end);
  if (o.checkpoints) check_interval(section, "checkpoints", *o.checkpoints, case_.end);
  for (auto at = o.pictures->begin(); case_.end > 0 && at != o.pictures->end(); ++at)
    if (std::find(o.pictures->begin(), at, *at) != at) {
      section.add("pictures", fmt::format("names {} twice", with_unit(*at, "s")));
      return;
    }
}

}  // namespace talus
