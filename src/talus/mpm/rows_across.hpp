#pragma once
/// Rows of nodes across the surfaces of solids. The nodes of a row are in contact together (`ContactColumn` in
/// kernel/contact.hpp).
///
/// `near(x)`: distance and normal of a place x at a solid.

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <type_traits>

#include "talus/geometry/solid_shape.hpp"
#include "talus/mpm/data/grid.hpp"
#include "talus/mpm/kernel/contact.hpp"

namespace talus {

/// In cells: tolerance of a place, and of neighbouring places.
inline constexpr double rounding_of_place = 1e-6, nearby = 1e-3;
/// Cells: points behind a solid thinner than this reach nodes in front of it.
inline constexpr int thin_below = 2;

/// Place of a node of the grid [m], also of one outside the domain.
template <int Dim>
Vec<3> place_of_node(const Domain<Dim>& domain, const std::type_identity_t<Index<Dim>>& node) {
  Vec<3> x{};
  for (int a = 0; a < Dim; ++a) x[a] = domain.origin[a] + domain.h * node[a];
  return x;
}

/// Whether a surface has no edge at a place on it: at a distance along it [m] its normal differs by an angle whose cosine is
/// at least `cosine`.
template <class Near>
bool is_smooth(Near near, const Vec<3>& x, const Vec<3>& normal, double distance, double cosine = 0.99) {
  for (int a = 0; a < 3; ++a) {
    Vec<3> along{};
    along[a] = 1;
    along = along - normal[a] * normal;
    for (double sign : {-1.0, 1.0})
      if (dot(near(x + (sign * distance) * along).normal, normal) < cosine) return false;
  }
  return true;
}

/// Nodes in a row along an axis across a surface.
template <int Dim>
struct RowAcross {
  int axis, step;                                     ///< 1 or -1, out of the surface
  int n, own;                                         ///< nodes, and which of them it is the row of
  std::array<double, ContactColumn::most> distances;  ///< from the deepest on [m]
  Vec<3> normal;                                      ///< of the surface where it crosses it

  /// Node k, if `self` is the node that it is the row of.
  Index<Dim> node(Index<Dim> self, int k) const {
    self[axis] += step * (k - own);
    return self;
  }
};

/// The row that a node of the grid belongs to at a solid, if the surface around it is smooth, the solid thick and nothing in
/// front of it. `here`: what is near the node; `is_taken(x)`: whether a place lies in another solid or outside; `axis`: along
/// which all rows run, or -1 for that nearest to the normal.
template <int Dim, class Near, class Taken>
std::optional<RowAcross<Dim>> row_across(const Domain<Dim>& domain, Near near, Taken is_taken,
                                         const std::type_identity_t<Index<Dim>>& node, const Nearness& here,
                                         int axis = -1) {
  const double h = domain.h;
  const auto axis_of = [&](const Vec<3>& normal) {
    if (axis >= 0) return axis;
    int most = 0;
    for (int a = 1; a < Dim; ++a)
      if (std::abs(normal[a]) > std::abs(normal[most]) + rounding_of_place) most = a;
    return most;
  };
  // Half the width of a cell across the surface: the node above the highest one then does not touch the surface.
  const auto width = [&](const Vec<3>& n) { return h * (std::abs(n[0]) + std::abs(n[1]) + std::abs(n[2])); };
  const auto is_above = [&](const Nearness& at) { return at.distance >= (0.5 - rounding_of_place) * width(at.normal); };
  const int along = axis_of(here.normal), step = here.normal[along] > 0 ? 1 : -1;
  const auto place_at = [&](int steps) {
    Index<Dim> there = node;
    there[along] += steps * step;
    return place_of_node(domain, there);
  };
  constexpr double alike = 0.8;  // the cosine of the angle between normals
  const auto belongs = [&](const Nearness& one, const Nearness& highest) {
    return axis_of(one.normal) == along && dot(one.normal, highest.normal) > alike;
  };
  int up = 0;
  Nearness highest = here;
  while (!is_above(highest)) {
    if (++up == ContactColumn::most) return std::nullopt;
    highest = near(place_at(up));
  }
  if (axis_of(highest.normal) != along || !belongs(here, highest)) return std::nullopt;
  if (is_taken(place_at(up))) return std::nullopt;
  RowAcross<Dim> row{along, step, 1, 0, {highest.distance}, highest.normal};
  int lowest = up;
  while (row.n < ContactColumn::most) {
    const Nearness next = lowest == 1 ? here : near(place_at(lowest - 1));
    const double least = row.distances[std::size_t(row.n - 1)] - 0.3 * h * std::abs(highest.normal[along]);
    if (is_above(next) || !belongs(next, highest) || next.distance > least) break;
    if (next.distance < -1.5 * width(next.normal)) break;  // no material reaches it
    row.distances[std::size_t(row.n++)] = next.distance;
    --lowest;
  }
  if (row.n == 1 || lowest > 0) return std::nullopt;
  // Where the row crosses the surface, by the two nodes about it.
  int behind = 1;
  while (behind + 1 < row.n && row.distances[std::size_t(behind)] > 0) ++behind;
  const double in_front = row.distances[std::size_t(behind - 1)],
               share = in_front / (in_front - row.distances[std::size_t(behind)]);
  const Vec<3> above = place_at(up - behind + 1);
  const Vec<3> crossing = above + share * (place_at(up - behind) - above);
  row.normal = near(crossing).normal;
  if (near(crossing - (thin_below * h) * row.normal).distance >= 0) return std::nullopt;
  // In a gully material reaches the nodes of both flanks, and each row would let it fall along its own. Not whole cells: as
  // edges often lie on nodes, rounding would decide.
  if (!is_smooth(near, crossing, row.normal, 1.9 * h, alike)) return std::nullopt;
  std::reverse(row.distances.begin(), row.distances.begin() + row.n);
  row.own = -lowest;
  return row;
}

/// The column of a row, at a node of a tile. `spin`: see there.
template <int Dim>
ContactColumn column_of(const Tile<Dim>& tile, int node, const RowAcross<Dim>& row, const Vec<3>& spin) {
  ContactColumn column;
  column.n = row.n;
  column.own = row.own;
  column.spin = spin;
  for (int k = 0; k < row.n; ++k) {
    Index<Dim> i = row.node(unflatten<Dim>(node, tile_edge), k), offset{};
    offset[row.axis] = i[row.axis] < 0 ? -1 : i[row.axis] >= tile_edge ? 1 : 0;
    i[row.axis] -= tile_edge * offset[row.axis];
    const int other = tile.neighbours[neighbour_at<Dim>(offset)];
    column.nodes[k] = other < 0 ? -1 : other * power(tile_edge, Dim) + flatten<Dim>(i, tile_edge);
    column.distances[k] = row.distances[std::size_t(k)];
  }
  return column;
}

}  // namespace talus
