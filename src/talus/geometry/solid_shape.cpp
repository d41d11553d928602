#include "talus/geometry/solid_shape.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "talus/base/overloaded.hpp"

namespace talus {

namespace {

constexpr double unbounded = std::numeric_limits<double>::infinity();

/// Distance and normal relative to the intersection of two shapes.
Nearness common(const Nearness& a, const Nearness& b) {
  if (a.distance > 0 && b.distance > 0) {  // beside their edge
    const double d = std::hypot(a.distance, b.distance);
    return {d, (a.distance / d) * a.normal + (b.distance / d) * b.normal};
  }
  return a.distance >= b.distance ? a : b;
}

/// Distance and normal relative to a layer between two planes normal to an axis.
Nearness layer(int axis, double low, double high, const Vec<3>& x) {
  Nearness n{std::max(low - x[axis], x[axis] - high), {}};
  n.normal[axis] = x[axis] > 0.5 * (low + high) ? 1 : -1;
  return n;
}

/// Distance and normal relative to a ball; only the first `n` coordinates count.
Nearness ball(const Vec<3>& centre, double radius, int n, const Vec<3>& x) {
  Vec<3> away{};
  for (int a = 0; a < n; ++a) away[a] = x[a] - centre[a];
  const double r = length(away);
  if (r == 0) return {-radius, {1, 0, 0}};
  return {r - radius, (1 / r) * away};
}

Nearness in_plane(const Polygon& polygon, const Vec<3>& x, int dim) {
  const Vec<2> at{x[0], x[dim - 1]};
  const auto& c = polygon.corners;
  double turn = 0;  // twice the area, positive if the corners go round against the clock
  for (std::size_t i = 0, j = c.size() - 1; i < c.size(); j = i++) turn += c[j][0] * c[i][1] - c[i][0] * c[j][1];
  Nearness n{unbounded, {}};
  Vec<2> normal{};
  double facing = 0;
  for (std::size_t i = 0, j = c.size() - 1; i < c.size(); j = i++) {
    const Vec<2> edge = c[i] - c[j], from = at - c[j];
    const double l = std::sqrt(dot(edge, edge)), s = dot(from, edge) / (l * l);
    const Vec<2> out = (turn > 0 ? 1 / l : -1 / l) * Vec<2>{edge[1], -edge[0]};
    const double height = dot(from, out);
    if (s >= 0 && s <= 1) {
      if (std::abs(height) < std::abs(n.distance)) {
        n.distance = height;
        normal = out;
        facing = unbounded;  // no corner is nearer than its edges
      }
      continue;
    }
    const Vec<2> off = from - (s < 0 ? 0.0 : 1.0) * edge;
    const double d = std::sqrt(dot(off, off));
    // A corner has the same distance from both its edges: the edge that faces the point more directly determines the
    // side.
    if (d < std::abs(n.distance) * (1 - 1e-12) ||
        (d <= std::abs(n.distance) * (1 + 1e-12) && std::abs(height) > facing)) {
      n.distance = std::copysign(d, height);
      facing = std::abs(height);
      normal = (1 / n.distance) * off;
    }
  }
  n.normal[0] = normal[0];
  n.normal[dim - 1] = normal[1];
  return n;
}

/// Distance and normal relative to a terrain. The line from the nearest place of the surface to the point is along the
/// normal; each iteration moves to the nearest place on the tangent plane.
Nearness above(const Terrain& terrain, const Vec<3>& x) {
  TerrainPlace place = terrain.at(x[0], x[1]);
  const double upright = x[2] - place.height;
  const double least = std::abs(upright) / std::hypot(1, terrain.steepest());
  constexpr double near_pixels =
      16;  // cells are four pixels wide at most, and nodes of interest three and a half cells deep
  if (least > near_pixels * terrain.heights().pixel) return {std::copysign(least, upright), place.normal()};
  Nearness nearest{std::copysign(unbounded, upright), {}};
  Vec<2> foot{x[0], x[1]};
  constexpr int most_feet = 12;
  for (int k = 0; k < most_feet; ++k) {
    const Vec<3> normal = place.normal(), from = x - Vec<3>{foot[0], foot[1], place.height};
    const double distance = length(from), along = dot(from, normal);
    if (distance < std::abs(nearest.distance)) nearest = {std::copysign(distance, upright), normal};
    const Vec<2> next{x[0] - along * normal[0], x[1] - along * normal[1]};
    const Vec<2> way = next - foot;
    if (std::sqrt(dot(way, way)) <= 1e-9 * terrain.heights().pixel) break;
    foot = next;
    place = terrain.at(foot[0], foot[1]);
  }
  return nearest;
}

}  // namespace

Nearness nearness(const SolidShape& shape, const Vec<3>& x, int dim) {
  return std::visit(Overloaded{[&](const HalfSpace& h) {
                                 return Nearness{dot(x - h.point, h.normal), h.normal};
                               },
                               [&](const Box& b) {
                                 Nearness n = layer(0, b.min[0], b.max[0], x);
                                 for (int a = 1; a < dim; ++a) n = common(n, layer(a, b.min[a], b.max[a], x));
                                 return n;
                               },
                               [&](const Sphere& s) { return ball(s.centre, s.radius, dim, x); },
                               [&](const Cylinder& c) {
                                 const Nearness round = ball(c.centre, c.radius, 2, x);
                                 return dim == 2 ? round
                                                 : common(round, layer(2, c.centre[2], c.centre[2] + c.height, x));
                               },
                               [&](const Polygon& p) {
                                 const Nearness n = in_plane(p, x, dim);
                                 return dim == 2 ? n : common(n, layer(1, p.from, p.to, x));
                               },
                               [&](const Ground& g) { return above(*g.surface, x); },
                               [&](const Mesh& m) {
                                 const TriangleMesh::Place place = m.surface->nearest(x);
                                 return Nearness{place.distance, place.normal};
                               }},
                    shape);
}

double thickness(const SolidShape& shape, int dim) {
  return std::visit(
      Overloaded{[](const HalfSpace&) { return unbounded; },
                 [&](const Box& b) {
                   double least = unbounded;
                   for (int a = 0; a < dim; ++a) least = std::min(least, b.max[a] - b.min[a]);
                   return least;
                 },
                 [](const Sphere& s) { return 2 * s.radius; },
                 [&](const Cylinder& c) { return dim == 2 ? 2 * c.radius : std::min(2 * c.radius, c.height); },
                 [&](const Polygon& p) {
                   double least = dim == 3 ? p.to - p.from : unbounded;
                   const auto& c = p.corners;
                   for (std::size_t i = 0, j = c.size() - 1; i < c.size(); j = i++) {
                     // The line across the middle of this edge: where it leaves the polygon again.
                     const Vec<2> edge = c[i] - c[j], middle = 0.5 * (c[i] + c[j]);
                     const double l = std::sqrt(dot(edge, edge));
                     Vec<2> in = (1 / l) * Vec<2>{-edge[1], edge[0]};
                     const Vec<2> probe = middle + (1e-6 * l) * in;
                     if (!contains(p,
                                   dim == 3 ? Vec<3>{probe[0], 0.5 * (p.from + p.to), probe[1]}
                                            : Vec<3>{probe[0], probe[1], 0},
                                   dim))
                       in = -1.0 * in;
                     for (std::size_t k = 0, m = c.size() - 1; k < c.size(); m = k++) {
                       if (k == i) continue;
                       const Vec<2> other = c[k] - c[m], to = c[m] - middle;
                       const double across = in[0] * other[1] - in[1] * other[0];
                       if (across == 0) continue;
                       const double s = (to[0] * other[1] - to[1] * other[0]) / across,
                                    along = (to[0] * in[1] - to[1] * in[0]) / across;
                       if (s > 0 && along >= 0 && along <= 1) least = std::min(least, s);
                     }
                   }
                   return least;
                 },
                 [](const Ground&) { return unbounded; }, [](const Mesh& m) { return m.surface->thickness(); }},
      shape);
}

Box bounding_box(const SolidShape& shape, int dim, const Box& otherwise) {
  return std::visit(Overloaded{[&](const HalfSpace&) { return otherwise; }, [&](const Ground&) { return otherwise; },
                               [&](const Sphere& s) {
                                 Box b{s.centre, s.centre};
                                 for (int a = 0; a < dim; ++a) {
                                   b.min[a] -= s.radius;
                                   b.max[a] += s.radius;
                                 }
                                 return b;
                               },
                               [](const Mesh& m) {
                                 return Box{m.surface->low(), m.surface->high()};
                               },
                               [&](const auto& region) { return bounding_box(region, dim); }},
                    shape);
}

double farthest(const SolidShape& shape, const Vec<3>& from, int dim) {
  const auto of_box = [&](const Box& b) {
    Vec<3> most{};
    for (int a = 0; a < dim; ++a) most[a] = std::max(std::abs(b.min[a] - from[a]), std::abs(b.max[a] - from[a]));
    return length(most);
  };
  return std::visit(Overloaded{[](const HalfSpace&) { return unbounded; }, [](const Ground&) { return unbounded; },
                               [&](const Sphere& s) { return length(s.centre - from) + s.radius; },
                               [&](const Mesh& m) {
                                 return of_box(Box{m.surface->low(), m.surface->high()});
                               },
                               [&](const auto& region) { return of_box(bounding_box(region, dim)); }},
                    shape);
}

}  // namespace talus
