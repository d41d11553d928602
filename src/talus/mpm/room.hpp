#pragma once
/// Volume available around nodes.

#include <algorithm>
#include <array>
#include <vector>

#include "talus/mpm/data/domain.hpp"

namespace talus {

/// Volume around a node: the integral of its shape function over the domain [m3], in plane strain for one metre of
/// thickness, axisymmetric per radian. The part behind walls is mirrored, like volumes of particles.
template <int Dim, class Shape>
class NodeRooms {
 public:
  NodeRooms(const Domain<Dim>& domain, const Shape& shape) {
    constexpr int points = 64, margin = 2;  // a cell, and nodes outside
    for (int a = 0; a < Dim; ++a) {
      const int n = domain.n_cells[a];
      std::vector<double> room(n + 1 + 2 * margin, 0.0);
      for (int k = 0; k < n * points; ++k) {
        const double x = (k + 0.5) / points;
        const double length = domain.axisymmetric && a == 0 ? domain.h * (domain.origin[a] + domain.h * x) : domain.h;
        const auto w = shape.at(x);
        for (int i = 0; i < Shape::support; ++i) room[int(w.first) + i + margin] += w.N[i] * length / points;
      }
      for (int side : {0, 1}) {
        const Wall& wall = domain.walls[2 * a + side];
        if (is_passable(wall.kind)) continue;
        const int on = margin + (side == 0 ? 0 : n), inwards = side == 0 ? 1 : -1;
        const double behind = room[on - inwards];
        room[on + inwards] += wall.is_contact() ? -behind : behind;
        if (wall.is_contact()) room[on] += 2 * behind;
      }
      along_[a].assign(room.begin() + margin, room.end() - margin);
      if (domain.is_periodic(a)) along_[a].assign(n + 1, domain.h);
    }
  }

  double at(const Index<Dim>& tile, int node) const {
    const Index<Dim> in_tile = unflatten<Dim>(node, tile_edge);
    double room = 1;
    for (int a = 0; a < Dim; ++a) {
      const int last = int(along_[a].size()) - 1;
      room *= along_[a][std::clamp(in_tile[a] + tile_edge * tile[a], 0, last)];
    }
    return room;
  }

 private:
  std::array<std::vector<double>, Dim> along_;  ///< each axis
};

}  // namespace talus
