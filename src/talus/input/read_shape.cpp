#include <fmt/format.h>

#include "talus/case/keys.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr std::size_t most_corners = 10000;

Box read_box(Section& s, int dim) {
  Section b = s.section("box", "all points between two corners");
  const Box box{vector_of(b.numbers({"min", "m", {}, "lower corner of the box"}, dim)),
                vector_of(b.numbers({"max", "m", {}, "upper corner of the box"}, dim))};
  if (const std::string why = fault(box, dim); !why.empty()) b.complain(why);
  b.close("a box");
  return box;
}

Cylinder read_cylinder(Section& s, int dim) {
  Section c = s.section("cylinder", "an upright cylinder; in plane strain a disk");
  Cylinder cylinder{vector_of(c.numbers({"centre", "m", {}, dim == 3 ? "centre of the base" : "centre"}, dim)),
                    c.number(keys::radius), 0};
  if (dim == 3) cylinder.height = c.number(keys::height);
  c.close("a cylinder");
  return cylinder;
}

/// A polygon, or an empty box in the place of one that is none.
Region read_polygon(Section& s, int dim) {
  Section p = s.section("polygon", "a polygon in the vertical plane");
  Polygon polygon{{}, 0, 0};
  for (const auto& corner : p.points({"corners", "m", {}, "corners of the polygon, in order"}, 2))
    polygon.corners.push_back({corner[0], corner[1]});
  if (dim == 3) {
    polygon.from = p.number({"from", "m", {}, "where the prism begins along y"});
    polygon.to = p.number({"to", "m", {}, "where the prism ends along y"});
  }
  const std::size_t n = polygon.corners.size();
  const std::string why =
      n > most_corners ? fmt::format("are {}; at most {} are possible", n, most_corners) : fault(polygon, dim);
  if (!why.empty()) p.complain("corners", why);
  p.close("a polygon");
  return why.empty() && n > 0 ? Region(polygon) : Region(Box{});
}

HalfSpace read_half_space(Section& s, int dim) {
  Section h = s.section("half_space", "all points behind a plane");
  const HalfSpace half{vector_of(h.numbers({"point", "m", {}, "a point on the plane"}, dim)),
                       vector_of(h.numbers({"normal", "1", {}, "direction out of the solid"}, dim))};
  h.close("a half-space");
  return half;
}

Sphere read_sphere(Section& s, int dim) {
  Section b = s.section("sphere", "a sphere; in plane strain a disk");
  const Sphere sphere{vector_of(b.numbers({"centre", "m", {}, "centre"}, dim)), b.number(keys::radius)};
  b.close("a sphere");
  return sphere;
}

}  // namespace

Region read_shape(Section& s, int dim) {
  Region region = Box{};
  if (s.has("box")) region = read_box(s, dim);
  if (s.has("cylinder")) region = read_cylinder(s, dim);
  if (s.has("polygon")) {
    const Region polygon = read_polygon(s, dim);
    if (std::holds_alternative<Polygon>(polygon)) region = polygon;
  }
  return region;
}

SolidShape read_solid_shape(Section& s, int dim) {
  expect_one_of(s, {"half_space", "box", "sphere", "cylinder", "polygon"});
  if (s.has("half_space")) return read_half_space(s, dim);
  if (s.has("sphere")) return read_sphere(s, dim);
  return std::visit(
      [](const auto& region) -> SolidShape {
        if constexpr (requires { SolidShape(region); }) return region;
        return HalfSpace{};
      },
      read_shape(s, dim));
}

}  // namespace talus
