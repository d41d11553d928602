#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "talus/base/units.hpp"
#include "talus/case/check.hpp"
#include "talus/case/material.hpp"

namespace talus {

namespace {

/// Materials that have no critical friction for `rough` surfaces, or another one than the materials before.
void check_rough_surface(MistakesOf surface, const Case& case_) {
  double friction = 0;
  FrictionRise rise;
  for (const Material& m : case_.materials) {
    const std::optional<double> of_one = critical_friction_of(m.law);
    const FrictionRise rise_of_one = friction_rise_of(m.law);
    if (!of_one)
      surface.add("kind", fmt::format("`rough` needs a law with a critical friction angle; material `{}` has none. Use "
                                      "{{ kind = \"friction\", friction = ... }} or \"no_slip\"",
                                      m.name));
    else if (friction != 0 && *of_one != friction)
      surface.add("kind", fmt::format("cannot be rough: materials differ in friction, {:.4g} and {:.4g}; write {{ kind "
                                      "= \"friction\", friction = ... }}",
                                      friction, *of_one));
    else if (friction != 0 && rise_of_one != rise)
      surface.add("kind",
                  "cannot be rough: friction of the materials increases differently with the rate; write { kind = "
                  "\"friction\", friction = ... }, which is constant");
    else {
      friction = *of_one;
      rise = rise_of_one;
    }
  }
}

void check_cells(MistakesOf domain, const Case& case_) {
  for (int a = 0; a < case_.dim; ++a) {
    const double length = case_.domain.max[a] - case_.domain.min[a];
    if (length <= 0) domain.add("max", fmt::format("must lie above `min` along {}", axis_names[a]));
    if (!(length > 0) || !(case_.cell > 0)) continue;
    const double cells = length / case_.cell;
    if (cells > most_cells_along_axis)
      domain.add("cell", fmt::format("makes {:.3g} cells along {}; at most 1e6 are possible", cells, axis_names[a]));
    else if (const int n = case_.n_cells[std::size_t(a)]; n < 1 || std::abs(cells - n) > 1e-6 * std::max(1.0, cells))
      domain.add("cell", fmt::format("does not divide the domain's length along {} ({}): {:.6g} cells; `max` there "
                                     "could be {}",
                                     axis_names[a], with_unit(length, "m"), cells,
                                     with_unit(case_.domain.min[a] + std::ceil(cells - 1e-6) * case_.cell, "m")));
  }
}

void check_periods(MistakesOf domain, const Case& case_) {
  for (int a = 0; a < case_.dim; ++a) {
    const auto is_periodic = [&](int side) { return case_.walls[std::size_t(side)].kind == WallKind::periodic; };
    const bool low = is_periodic(2 * a), high = is_periodic(2 * a + 1);
    const int n = case_.n_cells[std::size_t(a)];
    if (low != high)
      domain.in("walls").add(
          name_of_side(low ? 2 * a : 2 * a + 1),
          fmt::format("needs the opposite side `{}` to be periodic too", name_of_side(low ? 2 * a + 1 : 2 * a)));
    else if (low && n % periodic_multiple != 0)
      domain.add("max", fmt::format("makes a period of {} cells along {}; it must be a multiple of {}", n,
                                    axis_names[a], periodic_multiple));
  }
}

void check_around_axis(MistakesOf domain, const Case& case_) {
  MistakesOf walls = domain.in("walls");
  if (case_.walls[0].kind == WallKind::periodic) walls.add("x_min", "cannot be periodic: x is the radius");
  if (case_.domain.min[0] < 0) domain.add("min", "must not be below 0 along x, which is the radius");
  if (case_.domain.min[0] == 0 && case_.walls[0].kind != WallKind::slip)
    walls.add("x_min", "must be `slip`: x = 0 is the axis");
  for (int side = 0; side < 4; ++side)
    if (case_.walls[std::size_t(side)].kind == WallKind::symmetry)
      walls.add(name_of_side(side), "is not for axisymmetric cases; the axis itself is `slip`");
  if (case_.gravity[0] != 0) domain.add("gravity", "must act along the axis, y");
}

}  // namespace

void check_rough_surfaces(const Case& case_, std::vector<Mistake>& mistakes) {
  for (int side = 0; side < 2 * case_.dim; ++side)
    if (case_.walls[std::size_t(side)].kind == WallKind::rough)
      check_rough_surface({mistakes, {"domain", "walls", name_of_side(side)}}, case_);
  for (const Solid& solid : case_.solids) {
    const auto is_rough = [](const Wall& wall) { return wall.kind == WallKind::rough; };
    if (is_rough(solid.contact) || std::ranges::any_of(solid.zones.surfaces, is_rough))
      check_rough_surface(MistakesOf(mistakes, section_of(solid)).in("contact"), case_);
  }
}

void check_domain(const Case& case_, std::vector<Mistake>& mistakes) {
  MistakesOf domain(mistakes, {"domain"});
  check_cells(domain, case_);
  for (int side = 0; side < 2 * case_.dim; ++side)
    if (case_.walls[std::size_t(side)].kind == WallKind::symmetry && case_.gravity[side / 2] != 0)
      domain.in("walls").add(name_of_side(side), "cannot be a plane of symmetry: gravity is not parallel to it");
  check_periods(domain, case_);
  if (case_.axisymmetric) check_around_axis(domain, case_);
}

}  // namespace talus
