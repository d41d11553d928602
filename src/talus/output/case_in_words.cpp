#include "talus/output/case_in_words.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>
#include <string>
#include <vector>

#include "talus/base/units.hpp"

namespace talus {

namespace {

std::string surface_in_words(const Wall& surface) {
  switch (surface.kind) {
    case WallKind::friction:
      return fmt::format("friction {:.3g}{}{}", surface.friction,
                         surface.xi > 0 ? fmt::format(" and turbulent friction, xi = {:g} m/s2", surface.xi) : "",
                         surface.separates ? "" : ", no separation");
    case WallKind::symmetry: return "plane of symmetry";
    case WallKind::no_slip: return "no slip";
    case WallKind::periodic: return "periodic";
    case WallKind::outflow: return "outflow";
    default: return surface.separates ? "frictionless" : "frictionless, no separation";
  }
}

std::string length(double x) { return with_unit(x, "m"); }

/// Length of the sides of a box, to five digits: "2 m x 1 m".
std::string size_of(const Box& box, int dim) {
  std::vector<std::string> sides;
  for (int a = 0; a < dim; ++a) sides.push_back(length(std::stod(fmt::format("{:.5g}", box.max[a] - box.min[a]))));
  return fmt::format("{}", fmt::join(sides, " x "));
}

std::string body_in_words(const Case& case_, const BodySpec& body) {
  const Material& material = case_.materials[body.material];
  const char* shape = std::holds_alternative<Cylinder>(body.region)       ? "cylinder"
                      : std::holds_alternative<Polygon>(body.region)      ? "polygon"
                      : std::holds_alternative<Raster>(body.region)       ? "picture"
                      : std::holds_alternative<PointList>(body.region)    ? "list of points"
                      : std::holds_alternative<SurfaceLayer>(body.region) ? "layer on the ground"
                                                                          : "box";
  const std::string apart = body.spacing > 0 ? fmt::format(", particle spacing {}", length(body.spacing)) : "";
  return fmt::format(" Body `{}`: {} within {}, material {} (law {}){}.", body.name, shape,
                     size_of(bounding_box(body.region, case_.dim), case_.dim), material.name,
                     std::visit([](const auto& law) { return std::string(law.name); }, material.law), apart);
}

std::string load_in_words(const Case& case_, const SurfaceLoad& load) {
  std::vector<std::string> stresses;
  for (int a = 0; a < case_.dim; ++a) stresses.push_back(with_unit(load.traction[a], "Pa"));
  return fmt::format(" Load on side {} of `{}`: stress ({}){}{}.", side_choices[load.side].word,
                     case_.bodies[load.body].name, fmt::join(stresses, ", "),
                     load.within ? ", on a part of the side" : "", load.factor.empty() ? "" : ", varying in time");
}

std::string walls_in_words(const Case& case_) {
  std::vector<std::string> walls;
  for (int side = 0; side < 2 * case_.dim; ++side)
    if (case_.walls[side].kind != WallKind::open)
      walls.push_back(
          fmt::format("{}_{} {}", "xyz"[side / 2], side % 2 == 0 ? "min" : "max", surface_in_words(case_.walls[side])));
  return walls.empty() ? " No walls." : fmt::format(" Walls: {}.", fmt::join(walls, ", "));
}

std::string solid_in_words(const Solid& solid) {
  return fmt::format(" Solid `{}`: {}{}, {}.", solid.name, solid.hollow ? "hollow, " : "",
                     surface_in_words(solid.contact),
                     solid.motion.rests()         ? "at rest"
                     : solid.motion.angle.empty() ? "moving"
                                                  : "rotating");
}

}  // namespace

std::string in_words(const Case& case_) {
  std::string text = fmt::format("{}, domain {}, cells {}, gravity {}.",
                                 case_.axisymmetric ? "Axisymmetric (x is the radius; y upwards)"
                                 : case_.dim == 2   ? "Plane strain (x and y; y upwards)"
                                                    : "Three dimensions (z upwards)",
                                 size_of(case_.domain, case_.dim), length(case_.cell),
                                 with_unit(std::hypot(case_.gravity[0], case_.gravity[1], case_.gravity[2]), "m/s2"));
  for (const BodySpec& body : case_.bodies) text += body_in_words(case_, body);
  for (const SurfaceLoad& load : case_.loads) text += load_in_words(case_, load);
  text += walls_in_words(case_);
  for (const Solid& solid : case_.solids) text += solid_in_words(solid);
  return text + fmt::format(" Simulated time: {}.", with_unit(case_.end, "s"));
}

}  // namespace talus
