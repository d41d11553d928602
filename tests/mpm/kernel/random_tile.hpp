#pragma once
/// A tile of particles at random places, for kernels that are held against each other.

#include <random>

#include "mpm/by_hand.hpp"
#include "talus/backend/backend.hpp"
#include "talus/mpm/cell_order.hpp"
#include "talus/mpm/data/scratch.hpp"

namespace talus {

/// Particles anywhere in the tile at the origin and up to 0.4 cells beside it, in the order of slots, some of them moved on
/// since; random numbers at its nodes and in its particles.
template <int Dim, class Shape>
struct RandomTile {
  using Layout = TileLayout<Dim, Shape>;
  static constexpr double h = 0.3;

  Domain<Dim> domain = unit_cells<Dim>(8);
  Shape shape;
  std::vector<Body<Dim>> bodies;
  std::vector<Tile<Dim>> tiles;
  std::vector<MassVelocity> velocity;
  std::vector<Acceleration> acceleration;
  Scratch scratch;
  ScratchView s;
  std::mt19937_64 random{1};

  double number(double low = -1, double high = 1) { return std::uniform_real_distribution<>(low, high)(random); }
  Quad numbers() {
    Quad q(0.0);
    for (int k = 0; k < 4; ++k) q.set(k, number());
    return q;
  }

  RandomTile(int n, double moved, const Shape& sh, bool axisymmetric = false) : shape(sh) {
    domain.h = h;
    domain.axisymmetric = axisymmetric;
    std::vector<Vec<Dim>> places(std::size_t(n), Vec<Dim>{});
    for (auto& x : places)
      for (int a = 0; a < Dim; ++a) x[a] = h * number(0, 4);
    bodies.push_back({"", 1, LinearElastic{1, 0}, particles_at<Dim>(places), {}});
    const auto backend = make_serial();
    sort_by_cell(bodies, all_rows(bodies, *backend), domain, occupied_tiles(bodies, domain, *backend), *backend);
    auto& p = bodies[0].particles;
    for (int i = 0; i < n; ++i) {
      for (int a = 0; a < Dim; ++a) {
        p.position(a)[i] += h * moved * number();
        p.velocity(a)[i] = number();
      }
      p.mass()[i] = number(1, 2);
    }
    Index<Dim> own{};
    std::vector<CellRange<Dim>> cells(1);
    cells[0].low.fill(0);
    cells[0].high.fill(tile_edge - 1);
    tiles = tiles_around<Dim, Shape>({own}, cells, Index<Dim>{}, *backend);
    tiles[0].neighbours[1] = -1;  // beyond it there is nothing
    for (std::size_t i = 0; i < tiles.size() * Layout::n_nodes; ++i) {
      velocity.push_back(node_of<MassVelocity>(numbers()));
      acceleration.push_back(node_of<Acceleration>(numbers()));
    }
    s = scratch.view(n);
    for (int i = 0; i < n; ++i) {
      for (double* row : s.flux) row[i] = number();
      s.stiffness[i] = number();
    }
  }
  TilePoints<Dim, Shape> points() {
    return {bodies[0].particles.view(), {0, bodies[0].particles.size()}, Index<Dim>{}, shape};
  }
};

}  // namespace talus
