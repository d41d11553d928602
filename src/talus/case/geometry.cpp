#include "talus/case/geometry.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace talus {

namespace {

/// The point in the vertical plane of first and last axis.
Vec<2> in_plane(const Vec<3>& x, int dim) { return {x[0], x[dim - 1]}; }

double cross(const Vec<2>& a, const Vec<2>& b, const Vec<2>& c) {
  return (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0]);
}

bool on_edge(const Vec<2>& a, const Vec<2>& b, const Vec<2>& x) {
  const double length = std::hypot(b[0] - a[0], b[1] - a[1]);
  if (std::abs(cross(a, b, x)) > 1e-12 * length * length) return false;
  return x[0] >= std::min(a[0], b[0]) - 1e-12 * length && x[0] <= std::max(a[0], b[0]) + 1e-12 * length &&
         x[1] >= std::min(a[1], b[1]) - 1e-12 * length && x[1] <= std::max(a[1], b[1]) + 1e-12 * length;
}

bool contains_in_plane(const Polygon& polygon, const Vec<2>& x) {
  const auto& c = polygon.corners;
  bool inside = false;
  for (std::size_t i = 0, j = c.size() - 1; i < c.size(); j = i++) {
    if (on_edge(c[j], c[i], x)) return true;
    if ((c[i][1] > x[1]) != (c[j][1] > x[1]) &&
        x[0] < c[i][0] + (c[j][0] - c[i][0]) * (x[1] - c[i][1]) / (c[j][1] - c[i][1]))
      inside = !inside;
  }
  return inside;
}

double area(const Polygon& polygon) {
  const auto& c = polygon.corners;
  double twice = 0;
  for (std::size_t i = 0, j = c.size() - 1; i < c.size(); j = i++) twice += c[j][0] * c[i][1] - c[i][0] * c[j][1];
  return std::abs(twice) / 2;
}

bool edges_cross(const Vec<2>& a, const Vec<2>& b, const Vec<2>& c, const Vec<2>& d) {
  return cross(a, b, c) * cross(a, b, d) < 0 && cross(c, d, a) * cross(c, d, b) < 0;
}

template <class... F>
struct Overloaded : F... {
  using F::operator()...;
};
template <class... F>
Overloaded(F...) -> Overloaded<F...>;

}  // namespace

Box bounding_box(const Region& region, int dim) {
  return std::visit(Overloaded{[](const Box& b) { return b; },
                               [&](const Cylinder& c) {
                                 Box b{c.centre, c.centre};
                                 for (int a = 0; a < 2; ++a) {
                                   b.min[a] -= c.radius;
                                   b.max[a] += c.radius;
                                 }
                                 if (dim == 3) b.max[2] += c.height;
                                 return b;
                               },
                               [&](const Polygon& p) {
                                 Box b{{p.corners[0][0], p.from, 0}, {p.corners[0][0], p.to, 0}};
                                 b.min[dim - 1] = b.max[dim - 1] = p.corners[0][1];
                                 for (const Vec<2>& c : p.corners) {
                                   b.min[0] = std::min(b.min[0], c[0]);
                                   b.max[0] = std::max(b.max[0], c[0]);
                                   b.min[dim - 1] = std::min(b.min[dim - 1], c[1]);
                                   b.max[dim - 1] = std::max(b.max[dim - 1], c[1]);
                                 }
                                 return b;
                               }},
                    region);
}

bool contains(const Region& region, const Vec<3>& x, int dim) {
  return std::visit(
      Overloaded{[&](const Box& b) {
                   for (int a = 0; a < dim; ++a)
                     if (x[a] < b.min[a] || x[a] > b.max[a]) return false;
                   return true;
                 },
                 [&](const Cylinder& c) {
                   const double dx = x[0] - c.centre[0], dy = x[1] - c.centre[1];
                   if (dx * dx + dy * dy > c.radius * c.radius * (1 + 1e-12)) return false;
                   return dim == 2 || (x[2] >= c.centre[2] && x[2] <= c.centre[2] + c.height * (1 + 1e-12));
                 },
                 [&](const Polygon& p) {
                   return contains_in_plane(p, in_plane(x, dim)) && (dim == 2 || (x[1] >= p.from && x[1] <= p.to));
                 }},
      region);
}

double volume(const Region& region, int dim) {
  return std::visit(
      Overloaded{[&](const Box& b) {
                   double v = 1;
                   for (int a = 0; a < dim; ++a) v *= b.max[a] - b.min[a];
                   return v;
                 },
                 [&](const Cylinder& c) { return std::numbers::pi * c.radius * c.radius * (dim == 3 ? c.height : 1); },
                 [&](const Polygon& p) { return area(p) * (dim == 3 ? p.to - p.from : 1); }},
      region);
}

double volume_per_radian(const Region& region) {
  return std::visit(Overloaded{[&](const Box& b) { return 0.5 * (b.min[0] + b.max[0]) * volume(region, 2); },
                               [&](const Cylinder& c) { return c.centre[0] * volume(region, 2); },
                               [&](const Polygon& p) {
                                 // of the triangles that the edges make with the origin
                                 double moment = 0;
                                 for (std::size_t i = 0, j = p.corners.size() - 1; i < p.corners.size(); j = i++) {
                                   const Vec<2>&a = p.corners[j], &b = p.corners[i];
                                   moment += (a[0] + b[0]) / 6 * (a[0] * b[1] - b[0] * a[1]);
                                 }
                                 return std::abs(moment);
                               }},
                    region);
}

double depth_below_surface(const Region& region, const Vec<3>& x, int dim) {
  return std::visit(Overloaded{[&](const Box& b) { return b.max[dim - 1] - x[dim - 1]; },
                               [&](const Cylinder& c) {
                                 if (dim == 3) return c.centre[2] + c.height - x[2];
                                 const double dx = x[0] - c.centre[0];
                                 return c.centre[1] + std::sqrt(std::max(0.0, c.radius * c.radius - dx * dx)) - x[1];
                               },
                               [&](const Polygon& p) {
                                 const Vec<2> at = in_plane(x, dim);
                                 double top = at[1];
                                 for (std::size_t i = 0, j = p.corners.size() - 1; i < p.corners.size(); j = i++) {
                                   const Vec<2>&a = p.corners[j], &b = p.corners[i];
                                   if (at[0] < std::min(a[0], b[0]) || at[0] > std::max(a[0], b[0])) continue;
                                   if (a[0] == b[0])
                                     top = std::max({top, a[1], b[1]});
                                   else
                                     top = std::max(top, a[1] + (b[1] - a[1]) * (at[0] - a[0]) / (b[0] - a[0]));
                                 }
                                 return top - at[1];
                               }},
                    region);
}

std::string fault(const Region& region, int dim) {
  return std::visit(Overloaded{[&](const Box& b) -> std::string {
                                 for (int a = 0; a < dim; ++a)
                                   if (!(b.min[a] < b.max[a]))
                                     return "the box is empty: `min` must lie below `max` along every axis";
                                 return "";
                               },
                               [&](const Cylinder&) -> std::string { return ""; },
                               [&](const Polygon& p) -> std::string {
                                 const auto& c = p.corners;
                                 if (c.size() < 3) return "a polygon has at least three corners";
                                 if (dim == 3 && !(p.from < p.to))
                                   return "the prism is empty: `from` must lie below `to`";
                                 const Box b = bounding_box(p, dim);
                                 if (!(area(p) > 1e-9 * (b.max[0] - b.min[0]) * (b.max[dim - 1] - b.min[dim - 1])))
                                   return "the polygon has no area";
                                 for (std::size_t i = 0; i < c.size(); ++i)
                                   for (std::size_t j = i + 1; j < c.size(); ++j)
                                     if (edges_cross(c[i], c[(i + 1) % c.size()], c[j], c[(j + 1) % c.size()]))
                                       return "the polygon crosses itself: edges " + std::to_string(i + 1) + " and " +
                                              std::to_string(j + 1);
                                 return "";
                               }},
                    region);
}

}  // namespace talus
