#include <fmt/format.h>

#include <limits>

#include "talus/case/check.hpp"
#include "talus/case/defaults.hpp"
#include "talus/case/keys.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr Choice kinds[] = {{"plane_strain", "x and y; nothing moves or varies along z"},
                            {"3d", "x, y and z"},
                            {"axisymmetric", "x is the radius and y points upwards; nothing varies around the axis"}};
constexpr Parameter lower{"min", "m", {}, "lower corner of the domain"},
    upper{"max", "m", {}, "upper corner of the domain"},
    gravity{"gravity", "m/s2", {}, "acceleration of gravity, such as [\"0 m/s2\", \"-9.81 m/s2\"]"};
constexpr const char* meaning_of_wall = "wall on this side of the domain";
constexpr WallKind wall_kinds[] = {WallKind::open,     WallKind::outflow, WallKind::slip,     WallKind::no_slip,
                                   WallKind::friction, WallKind::rough,   WallKind::symmetry, WallKind::periodic};

void read_walls(Section& domain, Case& case_) {
  if (!domain.has("walls")) {
    for (int side = 0; side < 2 * case_.dim; ++side)
      domain.note("walls." + name_of_side(side), "open", meaning_of_wall);
    return;
  }
  Section walls = domain.section("walls", "what stands on the sides of the domain");
  for (int side = 0; side < 2 * case_.dim; ++side)
    case_.walls[std::size_t(side)] = read_surface(
        walls, {{side_choices[side].word, meaning_of_wall, wall_choices}, wall_kinds, separates_from_wall}, case_);
  walls.close("the walls; sides of the domain are named x_min, x_max, y_min, ...");
}

}  // namespace

void read_domain(Section& root, Case& case_) {
  Section s = root.section("domain", "the box the grid fills");
  const int kind = s.required_choice({"kind", "plane strain, three dimensions or around an axis", kinds});
  case_.dim = kind == 1 ? 3 : 2;
  case_.axisymmetric = kind == 2;
  case_.domain = {vector_of(s.numbers(lower, case_.dim)), vector_of(s.numbers(upper, case_.dim))};
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (!s.has("min") || !s.has("max"))  // nothing is held against half a domain
    case_.domain = {{unknown, unknown, unknown}, {unknown, unknown, unknown}};
  case_.cell = s.number(keys::cell);
  case_.gravity = vector_of(s.numbers(gravity, case_.dim));
  read_walls(s, case_);
  s.close("[domain]");
}

}  // namespace talus
