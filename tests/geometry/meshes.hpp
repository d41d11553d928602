#pragma once
/// Surfaces of triangles for tests: the corners of the triangles, three each, counterclockwise as seen from outside.

#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "talus/math/vec.hpp"

namespace talus::meshes {

inline void add(std::vector<Vec<3>>& corners, const Vec<3>& a, const Vec<3>& b, const Vec<3>& c) {
  corners.insert(corners.end(), {a, b, c});
}

/// A box of twelve triangles.
inline std::vector<Vec<3>> box(const Vec<3>& low, const Vec<3>& high) {
  std::vector<Vec<3>> corners;
  for (int axis = 0; axis < 3; ++axis)
    for (const bool upper : {false, true}) {
      const int u = (axis + 1) % 3, v = (axis + 2) % 3;  // axis, u, v are right-handed
      std::array<Vec<3>, 4> c;
      for (int k = 0; k < 4; ++k) {
        Vec<3>& x = c[std::size_t(k)];
        x[axis] = upper ? high[axis] : low[axis];
        x[u] = k == 1 || k == 2 ? high[u] : low[u];
        x[v] = k >= 2 ? high[v] : low[v];
      }
      if (!upper) std::swap(c[1], c[3]);
      add(corners, c[0], c[1], c[2]);
      add(corners, c[0], c[2], c[3]);
    }
  return corners;
}

/// An upright prism of `n` sides, whose edges lie on a cylinder that stands on `centre`.
inline std::vector<Vec<3>> cylinder(const Vec<3>& centre, double radius, double height, int n) {
  std::vector<Vec<3>> corners;
  const auto at = [&](int k, double z) {
    const double angle = 2 * std::numbers::pi * (k % n) / n;
    return centre + Vec<3>{radius * std::cos(angle), radius * std::sin(angle), z};
  };
  for (int k = 0; k < n; ++k) {
    add(corners, at(k, 0), at(k + 1, 0), at(k + 1, height));
    add(corners, at(k, 0), at(k + 1, height), at(k, height));
    add(corners, centre, at(k + 1, 0), at(k, 0));
    add(corners, centre + Vec<3>{0, 0, height}, at(k, height), at(k + 1, height));
  }
  return corners;
}

/// A tetrahedron, its corners in such an order that the fourth is behind the first three.
inline std::vector<Vec<3>> tetrahedron(const Vec<3>& a, const Vec<3>& b, const Vec<3>& c, const Vec<3>& behind) {
  std::vector<Vec<3>> corners;
  add(corners, a, b, c);
  add(corners, b, a, behind);
  add(corners, c, b, behind);
  add(corners, a, c, behind);
  return corners;
}

}  // namespace talus::meshes
