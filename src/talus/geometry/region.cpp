#include "talus/geometry/region.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>

#include "talus/base/overloaded.hpp"

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

/// Part of a vertical line inside a polygon, just right of x (side = 1) or left of it (-1); `of_span` measures the line
/// between two heights.
template <class OfSpan>
double length_beside(const Polygon& polygon, double x, int side, OfSpan of_span) {
  std::vector<double> heights;  // where edges cross the line, alternately into the polygon and out of it
  const auto& c = polygon.corners;
  for (std::size_t i = 0, j = c.size() - 1; i < c.size(); j = i++) {
    const Vec<2>&a = c[j], &b = c[i];
    const double left = std::min(a[0], b[0]), right = std::max(a[0], b[0]);
    if (side > 0 ? left <= x && x < right : left < x && x <= right)
      heights.push_back(a[1] + (b[1] - a[1]) * (x - a[0]) / (b[0] - a[0]));
  }
  std::sort(heights.begin(), heights.end());
  double length = 0;
  for (std::size_t i = 1; i < heights.size(); i += 2) length += of_span(heights[i - 1], heights[i]);
  return length;
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

/// Clips a polygon at `limit` along an axis of its plane and keeps the side `keep` (1: above, -1: below)
/// (Sutherland and Hodgman 1974, Commun. ACM 17:32).
std::vector<Vec<2>> cut(const std::vector<Vec<2>>& corners, int axis, double limit, double keep) {
  std::vector<Vec<2>> left;
  for (std::size_t i = 0, j = corners.size() - 1; i < corners.size(); j = i++) {
    const Vec<2>&a = corners[j], &b = corners[i];
    const double from = keep * (a[axis] - limit), to = keep * (b[axis] - limit);
    if ((from < 0) != (to < 0)) left.push_back(a + (from / (from - to)) * (b - a));
    if (to >= 0) left.push_back(b);
  }
  return left;
}

/// Area of the part of a disk around the origin that lies in a rectangle.
double area_in_rectangle(double radius, const Vec<2>& min, const Vec<2>& max) {
  // Between abscissae where the outline changes, it runs along the circle or along the rectangle.
  std::vector<double> at = {std::clamp(min[0], -radius, radius), std::clamp(max[0], -radius, radius)};
  for (double y : {min[1], max[1]})
    if (std::abs(y) < radius)
      for (double x : {-std::sqrt(radius * radius - y * y), std::sqrt(radius * radius - y * y)})
        if (x > at[0] && x < at[1]) at.push_back(x);
  std::sort(at.begin(), at.end());
  const auto under_circle = [&](double x) {  // integral of sqrt(r^2 - x^2)
    return 0.5 * (x * std::sqrt(std::max(0.0, radius * radius - x * x)) + radius * radius * std::asin(x / radius));
  };
  double sum = 0;
  for (std::size_t i = 0; i + 1 < at.size(); ++i) {
    const double a = at[i], b = at[i + 1], middle = 0.5 * (a + b),
                 half = std::sqrt(std::max(0.0, radius * radius - middle * middle));
    if (std::max(min[1], -half) >= std::min(max[1], half)) continue;
    const double circle = under_circle(b) - under_circle(a);
    sum += (max[1] < half ? max[1] * (b - a) : circle) - (min[1] > -half ? min[1] * (b - a) : -circle);
  }
  return sum;
}

/// Length of the overlap of two ranges; 0 if there is none.
double overlap(double a, double b, double low, double high) {
  return std::max(0.0, std::min(b, high) - std::max(a, low));
}

/// Row or column of a coordinate in pixels; the far edge of the last one belongs to it.
int pixel_at(double x, int n) { return x == n ? n - 1 : int(std::floor(x)); }

/// Thickness of a layer above a place of the plane [m].
double thickness_at(const SurfaceLayer& layer, const Vec<3>& x) {
  const PlanRaster& t = layer.thickness;
  const int column = t.column_of(x[0]), row = t.row_of(x[1]);
  return t.has(column, row) ? t.at(column, row) : 0;
}

/// Sum of f(column, row, thickness) over the pixels of a layer with positive thickness.
template <class F>
double sum_over_layer(const SurfaceLayer& layer, F f) {
  double sum = 0;
  for (int row = 0; row < layer.thickness.rows; ++row)
    for (int column = 0; column < layer.thickness.columns; ++column)
      if (layer.thickness.has(column, row) && layer.thickness.at(column, row) > 0)
        sum += f(column, row, layer.thickness.at(column, row));
  return sum;
}

}  // namespace

double points_in(const SurfaceLayer& layer) {
  double n = 0;
  for_each_point(layer, [&](const Vec<3>&, double) { ++n; });
  return n;
}

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
                               },
                               [&](const Raster& r) {
                                 Box b{{1e300, 1e300, 0}, {-1e300, -1e300, 0}};
                                 for (int row = 0; row < r.height; ++row)
                                   for (int column = 0; column < r.width; ++column) {
                                     if (!r.is_filled(column, row)) continue;
                                     const int from_below = r.height - 1 - row;
                                     b.min[0] = std::min(b.min[0], r.min[0] + column * r.pixel);
                                     b.max[0] = std::max(b.max[0], r.min[0] + (column + 1) * r.pixel);
                                     b.min[1] = std::min(b.min[1], r.min[1] + from_below * r.pixel);
                                     b.max[1] = std::max(b.max[1], r.min[1] + (from_below + 1) * r.pixel);
                                   }
                                 return b;
                               },
                               [](const SurfaceLayer& l) {
                                 Box b{{1e300, 1e300, 1e300}, {-1e300, -1e300, -1e300}};
                                 const PlanRaster& t = l.thickness;
                                 sum_over_layer(l, [&](int column, int row, double thickness) {
                                   const Vec<2> at = t.middle(column, row);
                                   const double bottom = l.base->at(at[0], at[1]).height;
                                   for (int a = 0; a < 2; ++a) {
                                     b.min[a] = std::min(b.min[a], at[a] - 0.5 * t.pixel);
                                     b.max[a] = std::max(b.max[a], at[a] + 0.5 * t.pixel);
                                   }
                                   b.min[2] = std::min(b.min[2], bottom);
                                   b.max[2] = std::max(b.max[2], bottom + thickness);
                                   return 0.0;
                                 });
                                 return b;
                               },
                               [&](const PointList& p) {
                                 Box b{p.places.at(0), p.places.at(0)};
                                 for (const Vec<3>& x : p.places)
                                   for (int a = 0; a < dim; ++a) {
                                     b.min[a] = std::min(b.min[a], x[a]);
                                     b.max[a] = std::max(b.max[a], x[a]);
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
                 },
                 [&](const Raster& r) {
                   return r.is_filled(pixel_at((x[0] - r.min[0]) / r.pixel, r.width),
                                      r.height - 1 - pixel_at((x[1] - r.min[1]) / r.pixel, r.height));
                 },
                 [&](const PointList&) { return false; },
                 [&](const SurfaceLayer& l) {
                   const double above = x[2] - l.base->at(x[0], x[1]).height;
                   return above >= 0 && above <= thickness_at(l, x);
                 }},
      region);
}

double volume(const Region& region, int dim) {
  return std::visit(
      Overloaded{
          [&](const Box& b) {
            double v = 1;
            for (int a = 0; a < dim; ++a) v *= b.max[a] - b.min[a];
            return v;
          },
          [&](const Cylinder& c) { return std::numbers::pi * c.radius * c.radius * (dim == 3 ? c.height : 1); },
          [&](const Polygon& p) { return area(p) * (dim == 3 ? p.to - p.from : 1); },
          [&](const Raster& r) { return double(std::count(r.filled.begin(), r.filled.end(), 1)) * r.pixel * r.pixel; },
          [&](const PointList& p) { return std::accumulate(p.volumes.begin(), p.volumes.end(), 0.0); },
          [&](const SurfaceLayer& l) {
            return l.thickness.pixel * l.thickness.pixel * sum_over_layer(l, [](int, int, double t) { return t; });
          }},
      region);
}

double volume(const Region& region, int dim, const Box& box) {
  return std::visit(
      Overloaded{[&](const Box& b) {
                   double v = 1;
                   for (int a = 0; a < dim; ++a) v *= overlap(b.min[a], b.max[a], box.min[a], box.max[a]);
                   return v;
                 },
                 [&](const Cylinder& c) {
                   const Vec<2> min{box.min[0] - c.centre[0], box.min[1] - c.centre[1]},
                       max{box.max[0] - c.centre[0], box.max[1] - c.centre[1]};
                   return area_in_rectangle(c.radius, min, max) *
                          (dim == 3 ? overlap(c.centre[2], c.centre[2] + c.height, box.min[2], box.max[2]) : 1);
                 },
                 [&](const Polygon& p) {
                   Polygon left = p;
                   for (int axis : {0, 1}) {
                     const int a = axis == 0 ? 0 : dim - 1;
                     left.corners = cut(left.corners, axis, box.min[a], 1);
                     if (!left.corners.empty()) left.corners = cut(left.corners, axis, box.max[a], -1);
                     if (left.corners.empty()) return 0.0;
                   }
                   return area(left) * (dim == 3 ? overlap(p.from, p.to, box.min[1], box.max[1]) : 1);
                 },
                 [&](const Raster& r) {
                   double v = 0;
                   for (int row = 0; row < r.height; ++row)
                     for (int column = 0; column < r.width; ++column)
                       if (r.is_filled(column, row)) {
                         const double x = r.min[0] + column * r.pixel, y = r.min[1] + (r.height - 1 - row) * r.pixel;
                         v += overlap(x, x + r.pixel, box.min[0], box.max[0]) *
                              overlap(y, y + r.pixel, box.min[1], box.max[1]);
                       }
                   return v;
                 },
                 [&](const PointList& p) {
                   double v = 0;
                   for (std::size_t i = 0; i < p.places.size(); ++i) {
                     bool in = true;
                     for (int a = 0; a < dim; ++a) in &= p.places[i][a] >= box.min[a] && p.places[i][a] <= box.max[a];
                     if (in) v += p.volumes[i];
                   }
                   return v;
                 },
                 [&](const SurfaceLayer& l) {
                   const double half = 0.5 * l.thickness.pixel;
                   return sum_over_layer(l, [&](int column, int row, double t) {
                     const Vec<2> at = l.thickness.middle(column, row);
                     const double bottom = l.base->at(at[0], at[1]).height;
                     return overlap(at[0] - half, at[0] + half, box.min[0], box.max[0]) *
                            overlap(at[1] - half, at[1] + half, box.min[1], box.max[1]) *
                            overlap(bottom, bottom + t, box.min[2], box.max[2]);
                   });
                 }},
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
                               },
                               // The reader refuses pictures and lists of points in axisymmetric runs.
                               [&](const auto&) { return volume(region, 2); }},
                    region);
}

double length_above(const Region& region, const Vec<3>& x, int dim) {
  const double from = x[dim - 1];
  const auto of_span = [from](double bottom, double top) { return std::max(0.0, top - std::max(bottom, from)); };
  return std::visit(
      Overloaded{
          [&](const Box& b) {
            for (int a = 0; a < dim - 1; ++a)
              if (x[a] < b.min[a] || x[a] > b.max[a]) return 0.0;
            return of_span(b.min[dim - 1], b.max[dim - 1]);
          },
          [&](const Cylinder& c) {
            if (!contains(region, dim == 3 ? Vec<3>{x[0], x[1], c.centre[2]} : Vec<3>{x[0], c.centre[1], 0}, dim))
              return 0.0;
            if (dim == 3) return of_span(c.centre[2], c.centre[2] + c.height);
            const double dx = x[0] - c.centre[0];
            const double half = std::sqrt(std::max(0.0, c.radius * c.radius - dx * dx));
            return of_span(c.centre[1] - half, c.centre[1] + half);
          },
          [&](const Polygon& p) {
            if (dim == 3 && (x[1] < p.from || x[1] > p.to)) return 0.0;
            // Just right and just left of the line, so that a line along a vertical edge counts as inside.
            return std::max(length_beside(p, x[0], +1, of_span), length_beside(p, x[0], -1, of_span));
          },
          [&](const Raster& r) {
            const int column = pixel_at((x[0] - r.min[0]) / r.pixel, r.width);
            const auto height = [&](int row) { return r.min[1] + (r.height - row) * r.pixel; };
            double length = 0;
            for (int row = 0; row < r.height; ++row) {
              const int top = row;
              while (r.is_filled(column, row)) ++row;
              if (row > top) length += of_span(height(row), height(top));
            }
            return length;
          },
          [&](const PointList&) { return 0.0; },
          [&](const SurfaceLayer& l) {
            const double bottom = l.base->at(x[0], x[1]).height;
            return of_span(bottom, bottom + thickness_at(l, x));
          }},
      region);
}

std::optional<std::pair<std::size_t, std::size_t>> coincident_points(const PointList& list, int dim) {
  const double edge = std::pow(*std::min_element(list.volumes.begin(), list.volumes.end()), 1.0 / dim);
  std::optional<std::pair<std::size_t, std::size_t>> first;
  // Points are sorted by the boxes of a fine raster that they lie in; the second raster is half a box apart, for points
  // on either side of a border of the first.
  for (const double shift : {0.0, 0.5}) {
    std::vector<std::pair<std::array<double, 3>, std::size_t>> boxes;
    for (std::size_t i = 0; i < list.places.size(); ++i) {
      std::array<double, 3> box{};
      for (int a = 0; a < dim; ++a) box[std::size_t(a)] = std::floor(list.places[i][a] / (0.01 * edge) + shift);
      boxes.emplace_back(box, i);
    }
    std::sort(boxes.begin(), boxes.end());
    for (std::size_t k = 1; k < boxes.size(); ++k) {
      const std::size_t a = boxes[k - 1].second, b = boxes[k].second;
      if (boxes[k - 1].first == boxes[k].first && (!first || b < first->second)) first = {a, b};
    }
  }
  return first;
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
                               },
                               [&](const auto&) -> std::string { return ""; }},
                    region);
}

}  // namespace talus
