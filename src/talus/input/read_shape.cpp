#include <fmt/format.h>

#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr std::size_t most_corners = 10000;

constexpr Numbers lower_of_box{{"min", "m", {}, "lower corner of the box"}, one_per_axis},
    upper_of_box{{"max", "m", {}, "upper corner of the box"}, one_per_axis},
    centre_of_shape{{"centre", "m", {}, "centre"}, one_per_axis},
    centre_of_base{{"centre", "m", {}, "centre of the base"}, one_per_axis},
    point{{"point", "m", {}, "a point on the plane"}, one_per_axis},
    normal{{"normal", "1", {}, "direction out of the solid"}, one_per_axis};
constexpr Points corners{{"corners", "m", {}, "corners of the polygon, in order"}, 2};
constexpr Parameter begin_of_prism{"from", "m", {}, "where the prism begins along y"},
    end_of_prism{"to", "m", {}, "where the prism ends along y"};

Box read_box(Section& s, int dim) {
  Section b = s.section(keys::box);
  const Box box{vector_of(b.numbers(lower_of_box, dim)), vector_of(b.numbers(upper_of_box, dim))};
  if (const std::string why = fault(box, dim); !why.empty()) b.complain(why);
  b.close();
  return box;
}

Cylinder read_cylinder(Section& s, int dim) {
  Section c = s.section(keys::cylinder);
  Cylinder cylinder{vector_of(c.numbers(dim == 3 ? centre_of_base : centre_of_shape, dim)), c.number(keys::radius), 0};
  if (dim == 3) cylinder.height = c.number(keys::height);
  c.close();
  return cylinder;
}

/// A polygon; an empty box if the input is not valid.
Region read_polygon(Section& s, int dim) {
  Section p = s.section(keys::polygon);
  Polygon polygon{{}, 0, 0};
  for (const auto& corner : p.points(corners)) polygon.corners.push_back({corner[0], corner[1]});
  if (dim == 3) {
    polygon.from = p.number(begin_of_prism);
    polygon.to = p.number(end_of_prism);
  }
  const std::size_t n = polygon.corners.size();
  const std::string why =
      n > most_corners ? fmt::format("are {}; at most {} are possible", n, most_corners) : fault(polygon, dim);
  if (!why.empty()) p.complain("corners", why);
  p.close();
  return why.empty() && n > 0 ? Region(polygon) : Region(Box{});
}

HalfSpace read_half_space(Section& s, int dim) {
  Section h = s.section(keys::half_space);
  const HalfSpace half{vector_of(h.numbers(point, dim)), vector_of(h.numbers(normal, dim))};
  h.close();
  return half;
}

Sphere read_sphere(Section& s, int dim) {
  Section b = s.section(keys::sphere);
  const Sphere sphere{vector_of(b.numbers(centre_of_shape, dim)), b.number(keys::radius)};
  b.close();
  return sphere;
}

}  // namespace

const Declaration& box_declaration() {
  static const Declaration d("a box", {required(lower_of_box), required(upper_of_box)});
  return d;
}
const Declaration& cylinder_declaration() {
  static const Declaration d("a cylinder", {required(centre_of_shape), required(keys::radius), depends(keys::height)});
  return d;
}
const Declaration& polygon_declaration() {
  static const Declaration d("a polygon", {required(corners), depends(begin_of_prism), depends(end_of_prism)});
  return d;
}
const Declaration& half_space_declaration() {
  static const Declaration d("a half-space", {required(point), required(normal)});
  return d;
}
const Declaration& sphere_declaration() {
  static const Declaration d("a sphere", {required(centre_of_shape), required(keys::radius)});
  return d;
}

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

SolidShape read_solid_shape(Section& s, int dim, const std::string& folder) {
  s.expect_one_of();
  if (s.has("mesh")) return read_mesh(s, dim, folder);
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
