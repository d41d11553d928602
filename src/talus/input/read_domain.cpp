#include <limits>

#include "talus/case/check.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr Choice kinds[] = {{"plane_strain", "x and y; nothing moves or varies along z"},
                            {"3d", "x, y and z"},
                            {"axisymmetric", "x is the radius and y points upwards; nothing varies around the axis"}};
constexpr Option kind_of_domain{"kind", "plane strain, three dimensions or around an axis", kinds};
constexpr Numbers lower{{"min", "m", {}, "lower corner of the domain"}, one_per_axis},
    upper{{"max", "m", {}, "upper corner of the domain"}, one_per_axis},
    gravity{{"gravity", "m/s2", {}, "acceleration of gravity, such as [\"0 m/s2\", \"-9.81 m/s2\"]"}, one_per_axis};

const Declaration& walls_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> sides;
    for (int side = 0; side < 6; ++side) {
      sides.push_back(optional(key_of_wall(side).option));
      sides.push_back(optional(key_of_wall(side).table));
    }
    return Declaration("the walls; sides of the domain are named x_min, x_max, y_min, ...", std::move(sides));
  }();
  return d;
}
constexpr Table walls_table{"walls", "boundary conditions on the sides of the domain", walls_declaration};

/// Over a terrain what leaves is gone; elsewhere it stops the run.
void read_walls(Section& domain, bool on_terrain, Case& case_) {
  if (on_terrain) case_.walls.fill(WallKind::outflow);
  if (!domain.has("walls")) {
    for (int side = 0; side < 2 * case_.dim; ++side)
      domain.note("walls." + name_of_side(side), on_terrain ? "outflow" : "open", key_of_wall(side).option.meaning);
    return;
  }
  Section walls = domain.section(walls_table);
  for (int side = 0; side < 2 * case_.dim; ++side)
    case_.walls[std::size_t(side)] = read_surface(walls, key_of_wall(side), case_);
  walls.close();
}

}  // namespace

const Declaration& domain_declaration() {
  static const Declaration d("[domain]", {required(kind_of_domain), depends(lower), depends(upper),
                                          required(keys::cell), required(gravity), optional(walls_table)});
  return d;
}

void read_domain(Section& root, Case& case_) {
  Section s = root.section(keys::domain);
  const int kind = s.required_choice(kind_of_domain);
  case_.dim = kind == 1 ? 3 : 2;
  case_.axisymmetric = kind == 2;
  if (root.has("terrain")) {
    expect_absent(s, {"min", "max"}, "a domain without [terrain], whose `crop` says what part of the map it is");
  } else {
    case_.domain = {vector_of(s.numbers(lower, case_.dim)), vector_of(s.numbers(upper, case_.dim))};
  }
  constexpr double unknown = std::numeric_limits<double>::quiet_NaN();
  if (!s.has("min") || !s.has("max"))  // nothing is held against half a domain
    case_.domain = {{unknown, unknown, unknown}, {unknown, unknown, unknown}};
  case_.cell = s.number(keys::cell);
  case_.gravity = vector_of(s.numbers(gravity, case_.dim));
  read_walls(s, root.has("terrain"), case_);
  s.close();
}

}  // namespace talus
