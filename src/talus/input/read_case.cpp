#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <numeric>

#include "talus/base/png.hpp"
#include "talus/base/table.hpp"
#include "talus/base/text.hpp"
#include "talus/base/units.hpp"
#include "talus/input/check_together.hpp"
#include "talus/input/read_law.hpp"
#include "talus/mpm/start/filling.hpp"
#include "talus/mpm/start/overburden.hpp"

namespace talus {

namespace {

constexpr const char* axis_names[] = {"x", "y", "z"};

/// Cells that a solid must be thick, so that two planes of nodes are its own: a particle touches nodes up to a cell and a
/// half away, and at a single plane it would be carried through by its own mass on the other side.
constexpr double least_thickness = 1;

constexpr double most_particles = 2e8;
/// Rows or snapshots of a run.
constexpr double most_instants = 1e6;
constexpr std::size_t most_corners = 10000;

Vec<3> vector_of(const std::vector<double>& values) {
  Vec<3> v{};
  for (std::size_t a = 0; a < values.size() && a < 3; ++a) v[int(a)] = values[a];
  return v;
}

/// The friction of the case's material on itself where a layer of it is sheared on and on; complains unless there is one.
double friction_of_rough_wall(Section& s, std::string_view key, const std::vector<Material>& materials) {
  double friction = 0;
  for (const Material& m : materials) {
    const double of_one = std::visit(
        []<class Law>(const Law& law) {
          if constexpr (HasCriticalFriction<Law>) return law.critical_friction();
          return std::nan("");
        },
        m.law);
    if (std::isnan(of_one))
      s.complain(key, fmt::format("cannot be rough: the law of `{}` has no critical friction; use no_slip or {{ kind = "
                                  "\"friction\", friction = ... }}",
                                  m.name));
    else if (friction != 0 && of_one != friction)
      s.complain(key, fmt::format("cannot be rough: materials differ in friction, {:.4g} and {:.4g}; write {{ kind = "
                                  "\"friction\", friction = ... }}",
                                  friction, of_one));
    else
      friction = of_one;
  }
  s.note(fmt::format("{}.friction", key), fmt::format("{:.4g}", friction), "critical friction of the material");
  return friction;
}

/// Reads what a surface does to material: a word, or a table where it takes numbers.
Wall read_wall(Section& s, const Option& option, std::span<const WallKind> kinds, bool smooth_separates,
               const std::vector<Material>& materials) {
  static constexpr std::string_view example = "write { kind = \"friction\", friction = 0.38 }";
  if (!s.is_table(option.key)) {
    const Wall wall(kinds[s.choice(option)], 0, smooth_separates);
    if (wall.kind == WallKind::friction) s.complain(option.key, fmt::format("lacks its coefficient; {}", example));
    if (wall.kind == WallKind::rough)
      return {WallKind::friction, friction_of_rough_wall(s, option.key, materials), true};
    return wall.kind == WallKind::slip ? wall : Wall(wall.kind);
  }
  Section t = s.section(option.key, option.meaning);
  Wall wall(kinds[t.required_choice({"kind", option.meaning, option.choices})]);
  if (wall.kind == WallKind::friction)
    wall.friction = t.number(
        {"friction", "1", Range::not_negative(), "Coulomb's coefficient: tangent of the angle of wall friction"});
  else if (t.has("friction"))
    t.complain("friction", fmt::format("goes with kind `friction` only; {}", example));
  if (wall.kind == WallKind::rough) wall = {WallKind::friction, friction_of_rough_wall(t, "kind", materials), true};
  if (wall.kind == WallKind::friction || wall.kind == WallKind::slip)
    wall.separates = t.flag("separates", wall.kind == WallKind::friction || smooth_separates,
                            "material may lift off; otherwise it is held");
  else if (t.has("separates"))
    t.complain("separates", "goes with kinds `slip` and `friction` only");
  t.close("a wall");
  return wall;
}

void read_domain(Section& root, Case& what) {
  Section s = root.section("domain", "the box the grid fills");
  static constexpr Choice kinds[] = {
      {"plane_strain", "x and y; nothing moves or varies along z"},
      {"3d", "x, y and z"},
      {"axisymmetric", "x is the radius and y points upwards; nothing varies around the axis"}};
  const int kind = s.required_choice({"kind", "plane strain, three dimensions or around an axis", kinds});
  what.dim = kind == 1 ? 3 : 2;
  what.axisymmetric = kind == 2;
  const Parameter min{"min", "m", {}, "lower corner of the domain"}, max{"max", "m", {}, "upper corner of the domain"};
  what.domain = {vector_of(s.numbers(min, what.dim)), vector_of(s.numbers(max, what.dim))};
  const bool known = s.has("min") && s.has("max");
  if (!known) what.domain = {};  // nothing is held against half a domain
  what.cell = s.number({"cell", "m", Range::positive(), "size of the grid's cells"});
  what.gravity = vector_of(
      s.numbers({"gravity", "m/s2", {}, "acceleration of gravity, such as [\"0 m/s2\", \"-9.81 m/s2\"]"}, what.dim));
  for (int a = 0; a < what.dim; ++a) {
    const double length = what.domain.max[a] - what.domain.min[a];
    if (!(length > 0)) {
      if (known) s.complain("max", fmt::format("must lie above `min` along {}", axis_names[a]));
      continue;
    }
    if (!(what.cell > 0)) continue;
    const double cells = length / what.cell;
    if (cells > 1e6) {
      s.complain("cell", fmt::format("makes {:.3g} cells along {}; at most 1e6 are possible", cells, axis_names[a]));
      continue;
    }
    what.n_cells[a] = int(std::lround(cells));
    if (what.n_cells[a] < 1 || std::abs(cells - what.n_cells[a]) > 1e-6 * std::max(1.0, cells))
      s.complain("cell",
                 fmt::format("does not divide the domain's length along {} ({}): {:.6g} cells; `max` there could be {}",
                             axis_names[a], with_unit(length, "m"), cells,
                             with_unit(what.domain.min[a] + std::ceil(cells - 1e-6) * what.cell, "m")));
  }
  static constexpr WallKind all_kinds[] = {WallKind::open,     WallKind::outflow,  WallKind::slip,
                                           WallKind::no_slip,  WallKind::friction, WallKind::rough,
                                           WallKind::symmetry, WallKind::periodic};
  Section walls = s.has("walls") ? s.section("walls", "what stands on the sides of the domain") : s;
  for (int side = 0; side < 2 * what.dim; ++side) {
    const std::string key = fmt::format("{}_{}", axis_names[side / 2], side % 2 == 0 ? "min" : "max");
    if (s.has("walls"))
      what.walls[side] =
          read_wall(walls, {key, "wall on this side of the domain", wall_choices}, all_kinds, false, what.materials);
    else
      s.note("walls." + key, "open", "wall on this side of the domain");
    if (what.walls[side].kind == WallKind::symmetry && what.gravity[side / 2] != 0)
      walls.complain(key, "cannot be a plane of symmetry: gravity goes through it");
  }
  for (int a = 0; a < what.dim; ++a) {
    const bool low = what.walls[2 * a].kind == WallKind::periodic,
               high = what.walls[2 * a + 1].kind == WallKind::periodic;
    if (low != high)
      walls.complain(fmt::format("{}_{}", axis_names[a], low ? "min" : "max"),
                     fmt::format("must have its like on the other side: `{}_{}` is not periodic", axis_names[a],
                                 low ? "max" : "min"));
    else if (low && what.n_cells[a] % periodic_multiple != 0)
      s.complain("max", fmt::format("makes a period of {} cells along {}; it must be a multiple of {}", what.n_cells[a],
                                    axis_names[a], periodic_multiple));
  }
  if (what.axisymmetric) {
    if (what.walls[0].kind == WallKind::periodic) walls.complain("x_min", "cannot be periodic: x is the radius");
    if (what.domain.min[0] < 0) s.complain("min", "must not be below 0 along x, which is the radius");
    if (what.domain.min[0] == 0 && what.walls[0].kind != WallKind::slip) {
      const std::string_view why =
          "must be `slip`: x = 0 is the axis, through which nothing passes and along which all may slide";
      if (s.has("walls"))
        walls.complain("x_min", why);
      else
        s.complain(fmt::format("`walls.x_min` {}", why));
    }
    for (int side = 0; side < 4; ++side)
      if (what.walls[side].kind == WallKind::symmetry)
        walls.complain(fmt::format("{}_{}", axis_names[side / 2], side % 2 == 0 ? "min" : "max"),
                       "is not for axisymmetric cases; the axis itself is `slip`");
    if (what.gravity[0] != 0) s.complain("gravity", "must act along the axis, y");
  }
  if (s.has("walls")) walls.close("the walls; sides of the domain are named x_min, x_max, y_min, ...");
  s.close("[domain]");
}

void read_materials(Section& root, bool as_in_the_paper, Case& what) {
  for (auto& [name, s] : root.named_sections("material", "what bodies are made of")) {
    Section& section = s;  // clang 14 takes no structured binding into a lambda
    if (as_in_the_paper) section.prefer("collisional_form", "rate");
    Material material{name, read_law(section), 0};
    std::visit(
        [&](const auto& law) {
          if constexpr (requires { law.for_element_tests_only; })
            section.complain("law", "is for element tests only; it has no meaning in a flow");
          else if constexpr (!requires { law.grain_density(); })
            material.density = section.number({"density", "kg/m3", Range::positive(), "bulk density at the start"});
        },
        material.law);
    section.close(fmt::format("law `{}`", name_of(material.law)));
    what.materials.push_back(std::move(material));
  }
}

/// Complains where instants do not increase or are not as many as what they are given for; what is read then is nothing.
template <class T>
void expect_instants(Section& s, std::string_view values, std::string_view times, LinearInTime<T>& f) {
  if (f.times.size() != f.values.size())
    s.complain(values, fmt::format("are {} for {} `{}`", f.values.size(), f.times.size(), times));
  else if (const auto at = std::adjacent_find(f.times.begin(), f.times.end(), std::greater_equal());
           at != f.times.end())
    s.complain(times, fmt::format("must increase: {} follows {}", with_unit(at[1], "s"), with_unit(at[0], "s")));
  else if (f.times.empty() && s.is_right())
    s.complain(times, "name no instant");
  else
    return;
  f = {};
}

/// What goes on at a rate from an instant until another.
template <class T>
LinearInTime<T> read_steady(Section& s, const T& rate) {
  const double from = s.number({"from", "s", Range::not_negative(), "instant at which it starts"}, 0.0);
  const std::optional<double> until = s.optional_number({"until", "s", Range::positive(), "instant at which it stops"});
  if (until && !(*until > from)) s.complain("until", "must be later than `from`");
  if (until && *until > from) return {{from, *until}, {T{}, (*until - from) * rate}, T{}};
  return {{from}, {T{}}, rate};
}

/// Complains unless exactly one of some keys is there.
void expect_one_of(Section& s, const std::vector<std::string_view>& keys) {
  int given = 0;
  for (std::string_view k : keys) given += s.has(k);
  if (given != 1) s.complain("must have exactly one of " + any_of(keys, "and"));
}

/// Reads whichever region there is.
Region read_region(Section& s, const Case& what) {
  const int dim = what.dim;
  Region region = Box{};
  if (s.has("box")) {
    Section b = s.section("box", "all points between two corners");
    region = Box{vector_of(b.numbers({"min", "m", {}, "lower corner of the box"}, dim)),
                 vector_of(b.numbers({"max", "m", {}, "upper corner of the box"}, dim))};
    if (const std::string f = fault(region, dim); !f.empty()) b.complain(f);
    b.close("a box");
  }
  if (s.has("cylinder")) {
    Section c = s.section("cylinder", "an upright cylinder; in plane strain a disk");
    Cylinder cylinder{vector_of(c.numbers({"centre", "m", {}, dim == 3 ? "centre of the base" : "centre"}, dim)),
                      c.number({"radius", "m", Range::positive(), "radius"}), 0};
    if (dim == 3) cylinder.height = c.number({"height", "m", Range::positive(), "height"});
    region = cylinder;
    c.close("a cylinder");
  }
  if (s.has("polygon")) {
    Section p = s.section("polygon", "a polygon in the vertical plane");
    Polygon polygon{{}, 0, 0};
    for (const auto& corner : p.points({"corners", "m", {}, "corners of the polygon, in order"}, 2))
      polygon.corners.push_back({corner[0], corner[1]});
    if (dim == 3) {
      polygon.from = p.number({"from", "m", {}, "where the prism begins along y"});
      polygon.to = p.number({"to", "m", {}, "where the prism ends along y"});
    }
    const std::size_t n = polygon.corners.size();
    const std::string f =
        n > most_corners ? fmt::format("are {}; at most {} are possible", n, most_corners) : fault(polygon, dim);
    if (!f.empty()) p.complain("corners", f);
    if (f.empty() && !polygon.corners.empty()) region = polygon;
    p.close("a polygon");
  }
  return region;
}

/// The dark pixels of a PNG file.
Region read_raster(Section& s, const Case& what, const std::string& folder) {
  Raster raster{{}, 0, 0, 0, {}};
  const std::string file = s.text("file", "PNG file; its dark pixels are the body");
  const Vec<3> min = vector_of(s.numbers({"min", "m", {}, "lower left corner of the picture"}, 2));
  raster.min = {min[0], min[1]};
  raster.pixel = s.number({"pixel", "m", Range::positive(), "edge of a pixel"});
  const double threshold = s.number(
      {"threshold", "1", Range::inside(0, 1), "brightness below which a pixel counts as dark, from black 0 to white 1"},
      0.5);
  if (what.dim == 3) s.complain("is for plane strain only");
  s.close("a picture");
  if (file.empty()) return Box{};
  try {
    const GreyImage image = read_png((std::filesystem::path(folder) / file).string());
    raster.width = image.width;
    raster.height = image.height;
    for (std::uint8_t brightness : image.pixels) raster.filled.push_back(brightness < 255 * threshold);
  } catch (const std::runtime_error& e) {
    s.complain("file", e.what());
    return Box{};
  }
  if (std::count(raster.filled.begin(), raster.filled.end(), 1) == 0) {
    s.complain("file", fmt::format("has no pixel darker than {}", threshold));
    return Box{};
  }
  return raster;
}

/// Points of a CSV file, in SI.
Region read_points(Section& s, const Case& what, const std::string& folder, std::optional<double> spacing) {
  const std::string file = s.text(
      "file", "CSV file of the particles' places, with columns x, y and in 3D z [m], and if you like volume [m3]");
  s.close("a list of points");
  if (file.empty()) return Box{};
  const std::string path = (std::filesystem::path(folder) / file).string();
  PointList list;
  try {
    const NumberTable table = read_csv(path);
    if (table.rows.empty()) throw std::runtime_error(fmt::format("{} holds no rows", path));
    std::vector<std::string_view> known(axis_names, axis_names + what.dim);
    known.push_back("volume");
    std::vector<int> columns;
    for (std::string_view name : known) columns.push_back(table.column(std::string(name)));
    for (int a = 0; a < what.dim; ++a)
      if (columns[a] < 0)
        throw std::runtime_error(fmt::format(
            "{} has no column `{}`; its first line must name the columns {}, and names {}", path, axis_names[a],
            fmt::join(known.begin(), known.begin() + what.dim, ","), fmt::join(table.names, ",")));
    for (const std::string& name : table.names)
      if (std::find(known.begin(), known.end(), name) == known.end())
        throw std::runtime_error(fmt::format("{} has a column `{}`, which is none of {}", path, name, any_of(known)));
    const bool with_volume = columns[what.dim] >= 0;
    if (with_volume && spacing)
      throw std::runtime_error(fmt::format("{} tells the volumes: leave out `spacing`", path));
    if (!with_volume && !spacing)
      throw std::runtime_error(fmt::format("{} does not tell volumes: give `spacing`, whose {} each particle has", path,
                                           what.dim == 2 ? "square" : "cube"));
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      const std::vector<double>& row = table.rows[i];
      Vec<3> x{};
      double v = with_volume ? row[columns[what.dim]] : std::pow(*spacing, what.dim);
      bool finite = std::isfinite(v);
      for (int a = 0; a < what.dim; ++a) {
        x[a] = row[columns[a]];
        finite &= std::isfinite(x[a]);
      }
      if (!finite)
        throw std::runtime_error(fmt::format("{}:{}: a value is missing or not finite", path, table.lines[i]));
      if (!(v > 0))
        throw std::runtime_error(fmt::format("{}:{}: the volume must be greater than 0", path, table.lines[i]));
      list.places.push_back(x);
      list.volumes.push_back(v);
    }
  } catch (const std::runtime_error& e) {
    s.complain("file", e.what());
    return Box{};
  }
  return list;
}

/// Edge of a body's largest particle [m].
double largest_particle(const BodySpec& body, int dim) {
  double largest = body.spacing;
  if (const auto* list = std::get_if<PointList>(&body.region))
    for (double v : list->volumes) largest = std::max(largest, width_at_start(body, v, dim));
  return largest;
}

/// A word, or the components of a stress that is the same everywhere.
void read_initial_stress(Section& s, const Case& what, BodySpec& body) {
  const Option option{"initial_stress",
                      "stress at the start; or a table of its components, { xx = \"-1 kPa\", yy = ..., zz = ... }",
                      initial_stress_choices};
  if (!s.is_table(option.key)) {
    body.initial_stress = InitialStress(s.required_choice(option));
    return;
  }
  body.initial_stress = InitialStress::given;
  Section t = s.section(option.key, option.meaning);
  static constexpr const char* normal[] = {"xx", "yy", "zz"};
  static constexpr const char* shear[] = {"xy", "yz", "zx"};
  for (int k = 0; k < 3; ++k)
    body.given_stress[k] = t.number({normal[k], "Pa", {}, "normal stress, tension positive, the same everywhere"});
  for (int k = 0; k < (what.dim == 3 ? 3 : 1); ++k)
    body.given_stress[3 + k] = t.number({shear[k], "Pa", {}, "shear stress, the same everywhere"}, 0.0);
  t.close("a stress");
}

void read_bodies(Section& root, Case& what, const std::string& folder) {
  for (auto& [name, s] : root.named_sections("body", "the bodies, each a region filled with particles")) {
    BodySpec body;
    body.name = name;
    const std::string material = s.text("material", "name of the body's material");
    body.material = -1;
    for (std::size_t m = 0; m < what.materials.size(); ++m)
      if (what.materials[m].name == material) body.material = int(m);
    if (body.material < 0 && !material.empty()) {
      std::vector<std::string_view> names;
      for (const Material& m : what.materials) names.push_back(m.name);
      s.complain("material", names.empty()
                                 ? "is not among the materials"
                                 : fmt::format("is not among the materials; there is {}", fmt::join(names, ", ")));
    }
    expect_one_of(s, {"box", "cylinder", "polygon", "image", "points"});
    if (what.axisymmetric)
      for (const char* key : {"image", "points"})
        if (s.has(key)) s.complain(key, "is not for axisymmetric cases; there is box, cylinder, polygon");
    const Parameter spacing{"spacing", "m", Range::positive(), "distance between particles at the start"};
    if (s.has("points")) {
      const std::optional<double> given = s.optional_number(spacing);
      Section points = s.section("points", "particles listed in a file");
      body.region = read_points(points, what, folder, given);
      if (s.has("lattice")) s.complain("lattice", "has no meaning for listed points");
    } else {
      if (s.has("image")) {
        Section image = s.section("image", "the dark pixels of a picture");
        body.region = read_raster(image, what, folder);
      } else {
        body.region = read_region(s, what);
      }
      body.spacing = s.number(spacing);
      body.lattice = Lattice(s.choice({"lattice", "where the particles stand", lattice_choices}));
      body.scatter = s.number({"scatter", "1", Range::between(0, 0.5),
                               "how far particles stand off the lattice, at random along each axis, over the spacing"},
                              0.0);
      if (body.scatter > 0)
        body.seed =
            s.whole_number("seed", 0, std::numeric_limits<int>::max(), 1, "which random places `scatter` takes");
      else if (s.has("seed"))
        s.complain("seed", "has no meaning without `scatter`");
    }
    body.velocity =
        s.has("velocity") ? vector_of(s.numbers({"velocity", "m/s", {}, "velocity at the start"}, what.dim)) : Vec<3>{};
    if (s.has("angular_velocity")) {
      const Parameter spin{"angular_velocity",
                           "rad/s",
                           {},
                           "turning about the middle of its mass at the start; in 2D positive from x to y"};
      if (what.dim == 2)
        body.angular_velocity[2] = s.number(spin);
      else
        body.angular_velocity = vector_of(s.numbers(spin, 3));
      if (what.axisymmetric)
        s.complain("angular_velocity", "is not for axisymmetric cases: nothing moves around the axis");
    }
    if (what.axisymmetric && body.lattice == Lattice::corner && bounding_box(body.region, 2).min[0] <= 0)
      s.complain("lattice", "must be `cells`: particles on the axis would have no volume");
    const AnyLaw* law = body.material >= 0 ? &what.materials[body.material].law : nullptr;
    if (const std::optional<Range> range = law ? void_ratios_of(*law) : std::nullopt)
      body.void_ratio = s.number({"void_ratio", "1", *range, "void ratio at the start"});
    read_initial_stress(s, what, body);

    const Box box = bounding_box(body.region, what.dim), kept = kept_by_symmetry(what);
    for (int a = 0; a < what.dim; ++a)
      if (what.domain.max[a] > what.domain.min[a] &&
          (std::max(box.min[a], kept.min[a]) < what.domain.min[a] - 1e-9 * what.cell ||
           std::min(box.max[a], kept.max[a]) > what.domain.max[a] + 1e-9 * what.cell)) {
        s.complain(fmt::format("lies outside the domain along {}: {} to {}, the domain reaches from {} to {}",
                               axis_names[a], with_unit(box.min[a], "m"), with_unit(box.max[a], "m"),
                               with_unit(what.domain.min[a], "m"), with_unit(what.domain.max[a], "m")));
        break;
      }
    const double largest = largest_particle(body, what.dim);
    if (s.has("points") && what.cell > 0 && largest > what.cell * (1 + 1e-9))
      s.complain("points",
                 fmt::format("hold a particle of edge {}, larger than the cells ({}): the grid would see holes",
                             with_unit(largest, "m"), with_unit(what.cell, "m")));
    if (what.cell > 0 && body.spacing > what.cell)
      s.complain("spacing",
                 fmt::format("is larger than the cells ({}): the grid would see holes; at most half a cell is usual",
                             with_unit(what.cell, "m")));
    const bool turns = dot(body.angular_velocity, body.angular_velocity) > 0;
    for (int a = 0; a < what.dim; ++a) {
      const bool cut = box.min[a] < kept.min[a] || box.max[a] > kept.max[a];
      if (box.max[a] <= kept.min[a] || box.min[a] >= kept.max[a])
        s.complain(fmt::format("lies behind the plane of symmetry across {}", axis_names[a]));
      else if (cut && body.velocity[a] != 0)
        s.complain("velocity", fmt::format("carries the body through the plane of symmetry across {}", axis_names[a]));
      if (cut && turns)
        s.complain("angular_velocity",
                   fmt::format("turns the body through the plane of symmetry across {}", axis_names[a]));
    }
    if (s.is_text("initial_stress", "k0")) {
      if (what.gravity[what.dim - 1] >= 0)
        s.complain("initial_stress", fmt::format("k0 needs gravity, downwards along {}", axis_names[what.dim - 1]));
      if (law && !has_lasting_contacts(*law))
        s.complain("initial_stress",
                   fmt::format("must be `zero` for law `{}`, whose grains carry nothing at rest", name_of(*law)));
    }
    if (law && body.void_ratio)
      if (const std::string why = fault_of_void_ratio(*law, *body.void_ratio); !why.empty())
        s.complain("void_ratio", why);
    s.close("a body");
    what.bodies.push_back(std::move(body));
  }
}

/// Complains of keys that go with another one only.
void expect_absent(Section& s, std::initializer_list<const char*> keys, std::string_view with) {
  for (const char* key : keys)
    if (s.has(key)) s.complain(key, fmt::format("goes with `{}` only", with));
}

/// The columns of a file as a displacement.
LinearInTime<Vec<3>> read_displacements(Section& s, const Case& what, const std::string& folder) {
  const std::string file = s.text("file", "CSV file of the motion, with columns time [s], x, y and in 3D z [m]");
  const std::string path = (std::filesystem::path(folder) / file).string();
  LinearInTime<Vec<3>> f;
  try {
    const NumberTable table = read_csv(path);
    if (table.rows.empty()) throw std::runtime_error(fmt::format("{} holds no rows", path));
    std::vector<std::string_view> known{"time"};
    known.insert(known.end(), axis_names, axis_names + what.dim);
    for (std::string_view name : known)
      if (table.column(std::string(name)) < 0)
        throw std::runtime_error(fmt::format("{} has no column `{}`; its first line must name the columns {}", path,
                                             name, fmt::join(known, ",")));
    if (table.names.size() != known.size())
      throw std::runtime_error(fmt::format("{} must have the columns {} and no others", path, fmt::join(known, ",")));
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      Vec<3> d{};
      for (double value : table.rows[i])
        if (!std::isfinite(value))
          throw std::runtime_error(fmt::format("{}:{}: a value is missing or not finite", path, table.lines[i]));
      for (int a = 0; a < what.dim; ++a) d[a] = table.rows[i][table.column(axis_names[a])];
      f.times.push_back(table.rows[i][table.column("time")]);
      f.values.push_back(d);
    }
    expect_instants(s, "file", "file", f);
  } catch (const std::runtime_error& e) {
    s.complain("file", e.what());
    f = {};
  }
  return f;
}

/// The turn of a solid about its axis.
void read_rotation(Section& s, const Case& what, PrescribedMotion& motion) {
  motion.centre = vector_of(s.numbers({"centre", "m", {}, "a point on the axis of the turn, at the start"}, what.dim));
  if (what.dim == 3) {
    motion.axis = vector_of(s.numbers({"axis", "1", {}, "direction about which the turn is right-handed"}, 3));
    const double length = std::sqrt(dot(motion.axis, motion.axis));
    if (length > 0)
      motion.axis = (1 / length) * motion.axis;
    else
      s.complain("axis", "must not be zero");
  }
  expect_one_of(s, {"rate", "angles"});
  if (s.has("rate"))
    motion.angle =
        read_steady(s, s.number({"rate", "rad/s", {}, "rate of the turn; in plane strain positive from x to y"}));
  else
    expect_absent(s, {"from", "until"}, "rate");
  if (s.has("angles")) {
    motion.angle.times = s.numbers({"times", "s", Range::not_negative(), "instants at which angles are given"}, 0);
    motion.angle.values = s.numbers({"angles", "rad", {}, "how far the solid has turned then"}, 0);
    expect_instants(s, "angles", "times", motion.angle);
  } else {
    expect_absent(s, {"times"}, "angles");
  }
  s.close("a rotation");
}

PrescribedMotion read_motion(Section& s, const Case& what, const std::string& folder) {
  PrescribedMotion motion;
  const bool turns = s.has("rotation");
  if (turns) {
    Section r = s.section("rotation", "how the solid turns");
    read_rotation(r, what, motion);
    if (what.axisymmetric) s.complain("rotation", "is not for axisymmetric cases: nothing moves around the axis");
  }
  const std::vector<std::string_view> displacements = {"velocity", "displacements", "file"};
  const auto given = std::count_if(displacements.begin(), displacements.end(), [&](auto key) { return s.has(key); });
  if (given > 1 || (given == 0 && !turns))
    s.complain(fmt::format("must have exactly one of {}, or `rotation`{}", any_of(displacements, "and"),
                           turns ? " alone" : ""));
  if (s.has("velocity"))
    motion.displacement =
        read_steady(s, vector_of(s.numbers({"velocity", "m/s", {}, "velocity of the solid"}, what.dim)));
  else
    expect_absent(s, {"from", "until"}, "velocity");
  if (s.has("displacements")) {
    LinearInTime<Vec<3>>& f = motion.displacement;
    f.times = s.numbers({"times", "s", Range::not_negative(), "instants at which displacements are given"}, 0);
    for (const auto& d : s.points({"displacements", "m", {}, "where the solid is then, from where it began"}, what.dim))
      f.values.push_back(vector_of(d));
    expect_instants(s, "displacements", "times", f);
  } else {
    expect_absent(s, {"times"}, "displacements");
  }
  if (s.has("file")) motion.displacement = read_displacements(s, what, folder);
  s.close("a motion");
  return motion;
}

SolidShape read_solid_shape(Section& s, const Case& what) {
  expect_one_of(s, {"half_space", "box", "sphere", "cylinder", "polygon"});
  const int dim = what.dim;
  if (s.has("half_space")) {
    Section h = s.section("half_space", "all points behind a plane");
    HalfSpace half{vector_of(h.numbers({"point", "m", {}, "a point on the plane"}, dim)),
                   vector_of(h.numbers({"normal", "1", {}, "direction out of the solid"}, dim))};
    const double length = std::sqrt(dot(half.normal, half.normal));
    if (length > 0)
      half.normal = (1 / length) * half.normal;
    else
      h.complain("normal", "must not be zero");
    h.close("a half-space");
    return half;
  }
  if (s.has("sphere")) {
    Section b = s.section("sphere", "a sphere; in plane strain a disk");
    Sphere sphere{vector_of(b.numbers({"centre", "m", {}, "centre"}, dim)),
                  b.number({"radius", "m", Range::positive(), "radius"})};
    b.close("a sphere");
    return sphere;
  }
  return std::visit(
      [](const auto& region) -> SolidShape {
        if constexpr (requires { SolidShape(region); }) return region;
        return HalfSpace{};
      },
      read_region(s, what));
}

void read_solids(Section& root, Case& what, const std::string& folder) {
  if (!root.has("solid")) return;
  for (auto& [name, s] : root.named_sections("solid", "rigid solids inside the domain")) {
    Solid solid{name, read_solid_shape(s, what), {}};
    solid.hollow = s.flag("hollow", false, "the solid is what lies outside its shape: a drum, a bowl, a pipe");
    solid.contact = read_wall(s, {"contact", "what its surface does to material", contact_choices}, contact_kinds, true,
                              what.materials);
    if (!s.has("contact")) s.complain("`contact` is missing: " + any_of({"slip", "no_slip", "friction", "rough"}));
    if (s.has("motion")) {
      Section m = s.section("motion", "how the solid moves; without it, it rests");
      solid.motion = read_motion(m, what, folder);
    }
    s.close("a solid");
    const double thin = thickness(solid, what.dim), least = least_thickness * what.cell;
    if (thin > 0 && thin < least * (1 - 1e-9))
      s.complain(fmt::format("is {} thick; it must be as thick as the cells at least, {}, or material leaks through",
                             with_unit(thin, "m"), with_unit(least, "m")));
    what.solids.push_back(std::move(solid));
  }
}

/// Complains of a load on a side that is not there to be loaded.
void expect_free_side(Section& s, const Case& what, const SurfaceLoad& load) {
  const int axis = load.side / 2;
  const Box box = bounding_box(what.bodies[std::size_t(load.body)].region, what.dim), kept = kept_by_symmetry(what);
  const double close = 1e-9 * what.cell;
  const bool low = load.side % 2 == 0;
  if (low ? box.min[axis] <= kept.min[axis] + close : box.max[axis] >= kept.max[axis] - close)
    s.complain("side", "lies on a plane of symmetry or behind it");
  else if (what.walls[load.side].kind == WallKind::periodic &&
           (low ? box.min[axis] <= what.domain.min[axis] + close : box.max[axis] >= what.domain.max[axis] - close))
    s.complain("side", "lies on a periodic side of the domain, where the body goes on");
  else if (what.axisymmetric && load.side == 0 && box.min[0] <= close)
    s.complain("side", "is the axis, which has no area");
}

/// What presses and pulls on the sides of bodies.
void read_loads(Section& root, Case& what) {
  if (!root.has("load")) return;
  for (auto& [name, s] : root.named_sections("load", "stresses on the sides of bodies")) {
    SurfaceLoad load;
    load.name = name;
    const std::string body = s.text("body", "name of the body that it acts on");
    std::vector<std::string_view> names;
    for (const BodySpec& b : what.bodies) names.push_back(b.name);
    const auto found = std::find(names.begin(), names.end(), body);
    load.body = int(found - names.begin());
    if (found == names.end()) {
      load.body = -1;
      if (!body.empty())
        s.complain("body", fmt::format("is not among the bodies; there is {}", fmt::join(names, ", ")));
    } else if (std::holds_alternative<PointList>(what.bodies[std::size_t(load.body)].region)) {
      s.complain("body", "has no sides: its particles are listed one by one");
    } else if (what.bodies[std::size_t(load.body)].lattice == Lattice::corner) {
      s.complain("body", "must have lattice = \"cells\": loads act half a spacing outside particles");
    }
    load.side =
        s.required_choice({"side", "side of the body", std::span(side_choices).first(2 * std::size_t(what.dim))});
    if (load.body >= 0) expect_free_side(s, what, load);
    expect_one_of(s, {"traction", "pressure"});
    if (s.has("traction"))
      load.traction =
          vector_of(s.numbers({"traction", "Pa", {}, "force per area on the body, along each axis"}, what.dim));
    if (s.has("pressure"))
      load.traction[load.side / 2] =
          (load.side % 2 == 0 ? 1 : -1) * s.number({"pressure", "Pa", {}, "force per area, straight into the body"});
    if (s.has("times") || s.has("factors")) {
      load.factor.times = s.numbers({"times", "s", Range::not_negative(), "instants at which factors are given"}, 0);
      load.factor.values = s.numbers({"factors", "1", {}, "what the load is multiplied by then; linear between"}, 0);
      expect_instants(s, "factors", "times", load.factor);
    }
    if (s.has("within")) {
      Section w = s.section("within", "the part of the side that it acts on; without it, all");
      load.within = Box{vector_of(w.numbers({"min", "m", {}, "lower corner"}, what.dim)),
                        vector_of(w.numbers({"max", "m", {}, "upper corner"}, what.dim))};
      for (int a = 0; a < what.dim; ++a)
        if (w.is_right() && !(load.within->max[a] > load.within->min[a])) {
          w.complain("max", fmt::format("must exceed `min` along {}", axis_names[a]));
          break;
        }
      w.close("a part of space");
    }
    s.close("a load");
    what.loads.push_back(std::move(load));
  }
}

/// The default of `cfl`, and why: what a particle alone, pressed along all axes, bears at the worst place, dt < 2 sqrt(2/3)
/// /sqrt(S) h/c with Poisson's ratio 0.2, where S = max sum N'^2/N: 6 for quadratic, 3.14 for cubic splines. uGIMP has
/// 2/l + 1/(1 - l) with a half-width of l cells, 9.3 with two particles a cell and axis; it becomes the hat as l goes to
/// 0. With hat functions, whose S has no bound, bodies break at 1: a particle that has just entered a cell pushes on
/// nodes that have next to no mass (docs/performance.md, docs/numerics.md).
std::pair<double, std::string_view> longest_step_of(ShapeFunction shape) {
  switch (shape) {
    case ShapeFunction::quadratic: return {0.65, "for quadratic shape functions"};
    case ShapeFunction::linear: return {0.5, "for linear shape functions"};
    case ShapeFunction::cubic: return {0.9, "for cubic shape functions"};
    case ShapeFunction::ugimp: return {0.5, "for uGIMP"};
  }
  return {0.5, ""};
}

void read_numerics(Section& s, Case& what) {
  Numerics& n = what.numerics;
  n.preset = Preset(s.choice({"preset", "where the defaults of the other keys come from", preset_choices}));
  const bool paper = n.preset == Preset::paper;
  if (paper) {
    s.prefer("shape", "linear");
    s.prefer("transfer", "flip");
    s.prefer("integrator", "forward_euler");
  }
  n.shape_function = ShapeFunction(s.choice({"shape", "shape functions", shape_function_choices}));
  n.transfer = Transfer(s.choice({"transfer", "how velocity goes between particles and grid", transfer_choices}));
  if (is_affine(n.transfer) && n.shape_function == ShapeFunction::linear)
    s.complain("transfer",
               fmt::format("{} needs smoother shapes: with hat functions nodes that have next to no mass take "
                           "a velocity out of proportion, and energy comes from nowhere; use shape = "
                           "\"quadratic\", or a transfer that is not affine",
                           word_of(n.transfer)));
  if (has_tau(n.transfer)) {
    const Parameter tau{"tau", "s", Range::positive(), "time in which velocity that the grid cannot hold decays"};
    double low = std::numeric_limits<double>::infinity(), high = -low;
    for (const BodySpec& b : what.bodies) {
      const Box box = bounding_box(b.region, what.dim);
      low = std::min(low, box.min[what.dim - 1]);
      high = std::max(high, box.max[what.dim - 1]);
    }
    const double g = std::sqrt(dot(what.gravity, what.gravity));
    if (g > 0 && high > low)
      n.tau = s.number(tau, 0.08 * std::sqrt((high - low) / g), "0.08 sqrt(H/g), with the height H of all bodies");
    else if (s.is_right())  // nothing falls, so nothing tells how fast it goes
      n.tau =
          s.number({tau.key, tau.unit, tau.range,
                    "time in which velocity that the grid cannot hold decays: a hundredth of that of the motion; or "
                    "take transfer = \"apic\" for bodies that turn, \"flip\" for elastic waves"});
    else  // there is a default perhaps, once what it follows from is right
      n.tau = s.optional_number(tau).value_or(0);
  } else {
    n.flip_share = s.number(
        {"flip_share", "1", Range::between(0, 1), "share of the particles' own velocity that is kept each step"}, 1.0);
  }
  n.order = Order(s.choice({"order", "when the stress is updated", order_choices}));
  n.f_bar = s.flag("f_bar", false, "average the rate of volume change over each cell (not with average_pressure)");
  n.average_pressure = s.flag("average_pressure", !n.f_bar && !paper, "average the elastic compression over each cell");
  if (n.f_bar && n.average_pressure)
    s.complain("average_pressure", "must be false with `f_bar`: it averages the rate of volume change as well");
  n.particle_shifting = s.flag("particle_shifting", !paper,
                               "move particles apart where they stand closer than their volumes leave room for");
  static constexpr Choice integrators[] = {integrator_choices[1], integrator_choices[0], integrator_choices[2]};
  static constexpr Integrator schemes[] = {Integrator::return_mapping, Integrator::modified_euler,
                                           Integrator::forward_euler};
  n.integration.scheme = schemes[s.choice({"integrator", "how the frictional stress is integrated", integrators})];
  n.integration.tolerance =
      n.integration.scheme == Integrator::modified_euler
          ? s.number({"tolerance", "1", Range::between(1e-12, 0.1), "relative error of a substep of the integrator"},
                     1e-3)
          : 1e-3;
  const Parameter dt{"dt", "s", Range::positive(), "fixed time step; without it the step adapts"};
  n.dt = paper ? s.number(dt, 1e-6, "as in the paper") : s.optional_number(dt);
  const auto [cfl, whose] = longest_step_of(n.shape_function);
  n.cfl = s.number({"cfl", "1", {0, 1, true, false}, "share of a cell that waves and particles may cross in a step"},
                   cfl, whose);
  n.stiffness_factor =
      s.number({"stiffness_factor",
                "1",
                {0, 1, true, false},
                "multiplies the elastic stiffness of every material: below 1 steps are longer, waves slower"},
               1.0);
  if (n.stiffness_factor != 1)
    for (const Material& m : what.materials)
      if (!scales_stiffness(m.law))
        s.complain("stiffness_factor",
                   fmt::format("must be 1: law `{}` of material `{}` has no elastic stiffness to scale", name_of(m.law),
                               m.name));
  s.close("[numerics]");
}

/// How thin a deposit can be, and why: no layer of grains is thinner than a grain, and experiments see none. Of a law
/// that does not know its grains, a layer of points.
std::pair<double, std::string_view> thinnest_deposit(const Case& what) {
  double grain = 0, particle = 0;
  for (const BodySpec& b : what.bodies) {
    particle = std::max(particle, largest_particle(b, what.dim));
    if (b.material >= 0)
      std::visit(
          [&](const auto& law) {
            if constexpr (requires { law.grain_diameter(); }) grain = std::max(grain, law.grain_diameter());
          },
          what.materials[b.material].law);
  }
  if (grain > 0) return {grain, "a grain"};
  return {particle, "a particle at the start"};
}

void read_output(Section& root, Case& what) {
  Section s = root.has("output") ? root.section("output", "what is written") : Section::empty(root, "output");
  OutputSpec& o = what.output;
  const double end = what.end;
  o.snapshots =
      s.number({"snapshots", "s", Range::positive(), "time between snapshots"}, end / 50, "a fiftieth of the run");
  o.history = s.number({"history", "s", Range::positive(), "time between rows of history.csv"}, end / 500,
                       "a five-hundredth of the run");
  const auto [thinnest, whose] = thinnest_deposit(what);
  o.front_thickness =
      s.number({"front_thickness", "m", Range::positive(), "how thick the deposit is where it ends: fronts are there"},
               thinnest, whose);
  if (s.has("pictures")) {
    const Range in_the_run = end > 0 ? Range::between(0, end) : Range::not_negative();
    o.pictures = s.numbers({"pictures", "s", in_the_run, "instants of which pictures are made"}, 0);
  } else {
    for (int i = 0; i <= 5; ++i) o.pictures.push_back(end * i / 5);
    s.note("pictures", "six instants from the start to the end", "instants of which pictures are made");
  }
  std::vector<std::string_view> known;
  for (const Quantity& q : common_quantities) known.push_back(q.name);
  for (const Material& m : what.materials)
    std::visit(
        [&](const auto& law) {
          for (const auto& q : law.quantities()) known.push_back(q.name);
        },
        m.law);
  std::vector<std::string_view> usual(std::begin(usual_fields), std::end(usual_fields));
  if (has_outflow(what)) usual.push_back("id");
  o.fields = s.words("fields", known, usual, "quantities in snapshots");
  o.checkpoints = s.optional_number(
      {"checkpoints", "s", Range::positive(), "simulated time between checkpoints, beside those by the clock"});
  o.checkpoint_wall = s.number({"checkpoint_wall", "s", Range::positive(), "time on the clock between checkpoints"},
                               OutputSpec{}.checkpoint_wall);
  const auto expect_interval = [&](std::string_view key, double interval) {
    if (!(end > 0 && interval > 0)) return;
    if (interval > end)
      s.complain(key, fmt::format("is longer than the run, {}", with_unit(end, "s")));
    else if (end / interval > most_instants)
      s.complain(key, fmt::format("makes {:.3g} instants; at most {:.0e} are possible", end / interval, most_instants));
  };
  expect_interval("snapshots", o.snapshots);
  expect_interval("history", o.history);
  if (o.checkpoints) expect_interval("checkpoints", *o.checkpoints);
  s.close("[output]");
}

double estimated_particles(const BodySpec& body, int dim) {
  if (const auto* list = std::get_if<PointList>(&body.region)) return double(list->places.size());
  return body.spacing > 0 ? volume(body.region, dim) / std::pow(body.spacing, dim) : 0;
}

}  // namespace

Case understand_case(Document& document, const std::string& folder) {
  Case what;
  Section root = Section::root(document);
  what.title = root.text("title", "what the case is, in one line");
  Section numerics = root.has("numerics") ? root.section("numerics", "how the equations are solved")
                                          : Section::empty(root, "numerics");
  read_materials(root, numerics.is_text("preset", "paper"), what);
  read_domain(root, what);
  read_bodies(root, what, folder);
  read_loads(root, what);
  read_solids(root, what, folder);
  read_numerics(numerics, what);
  Section run = root.section("run", "how long");
  what.end = run.number({"end", "s", Range::positive(), "simulated time at which the run ends"});
  run.close("[run]");
  read_output(root, what);
  root.close("a case");
  if (const double n = estimated_particles(what); n > most_particles)
    root.complain(fmt::format(
        "the bodies would hold about {:.3g} particles; at most {:.0g} are possible. A larger `spacing` makes fewer", n,
        most_particles));
  if (document.is_right()) check_together(root, what);
  return what;
}

double estimated_particles(const Case& what) {
  double n = 0;
  for (const BodySpec& b : what.bodies) n += estimated_particles(b, what.dim);
  return n;
}

double estimated_bytes(const Case& what) {
  double numbers = 0;
  for (const BodySpec& b : what.bodies) {
    const double of_a_particle = std::visit(
        [&]<class Law>(const Law&) {
          // stored: place, velocity, mass, volume, id, state; seen: what every law tells, and what this one does
          double n = 2 * what.dim + 3 + state_size<Law> +
                     (is_affine(what.numerics.transfer) ? what.dim * what.dim : 0) + double(what.loads.size());
          for (const Quantity& q : common_quantities) n += q.components;
          for (const Quantity& q : Law::quantities()) n += q.components;
          return n;
        },
        what.materials[b.material].law);
    numbers += estimated_particles(b, what.dim) * of_a_particle;
  }
  return sizeof(double) * numbers;
}

CaseFile read_case_text(const std::string& name, std::string_view text, const std::string& folder) {
  Document document(name, text);
  Case what = understand_case(document, folder.empty() ? std::filesystem::path(name).parent_path().string() : folder);
  document.finish();
  return {std::move(what), std::move(document.understood())};
}

CaseFile read_case(const std::string& path) {
  Document document(path);
  Case what = understand_case(document, std::filesystem::path(path).parent_path().string());
  document.finish();
  return {std::move(what), std::move(document.understood())};
}

}  // namespace talus
