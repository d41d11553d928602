/// What particles and nodes tell each other: the particles of one tile, the window of the tile in cache. Times include
/// the weights of the shape function, as in a step.

#include <random>
#include <string>
#include <type_traits>
#include <vector>

#include "mpm/kernel/random_tile.hpp"
#include "per_item.hpp"
#include "talus/mpm/kernel/pieces.hpp"
#include "talus/mpm/kernel/runs.hpp"

namespace talus {
namespace {

/// A tile full of particles, 2^Dim in a cell, anywhere in it, in the order of the cells; and windows of nodal values.
template <int Dim, class Shape>
struct FullTile {
  using Layout = TileLayout<Dim, Shape>;
  static constexpr Index<Dim> place{};  ///< the tile's cells begin at the origin

  std::vector<FourPlaces<Dim>> fours;  ///< the particles, four at a time [cells]
  MassVelocity velocity[Layout::n_window];
  NodeMotion motion[Layout::n_window];
  ForceStiffness sums[Layout::n_window];

  FullTile() {
    std::mt19937_64 random(1);
    std::uniform_real_distribution<> uniform(0, 1);
    for (int c = 0; c < Layout::n_cells; ++c)
      for (int i = 0; i < power(2, Dim) / 4; ++i) {
        FourPlaces<Dim> x;
        const Index<Dim> cell = unflatten<Dim>(c, tile_edge);
        for (int axis = 0; axis < Dim; ++axis)
          for (int lane = 0; lane < 4; ++lane) x[axis].set(lane, cell[axis] + uniform(random));
        fours.push_back(x);
      }
    for (int i = 0; i < Layout::n_window; ++i) {
      velocity[i] = node_of<MassVelocity>(Quad(uniform(random)));
      motion[i] = {velocity[i], node_of<Acceleration>(Quad(uniform(random)))};
      sums[i] = node_of<ForceStiffness>(Quad(uniform(random)));
    }
  }

  /// Times f(weights) for every particle.
  template <class F>
  void time(benchmark::State& timer, F f) {
    for (auto _ : timer) {
      for (const FourPlaces<Dim>& x : fours) {
        const FourWeights<Dim, Shape> w(x, place);
        for (int lane = 0; lane < 4; ++lane) f(ParticleWeights<Dim, Shape>{w, lane});
      }
      benchmark::ClobberMemory();
    }
    timer.counters["ns"] = ns_per_item(4.0 * double(fours.size()));
  }
};

template <int Dim, class Shape>
void gather_gradient(benchmark::State& timer) {
  FullTile<Dim, Shape> tile;
  tile.time(timer, [&](const auto& w) {
    Quad columns[Dim];
    gradient(w, tile.velocity, columns);
    benchmark::DoNotOptimize(columns);
  });
}

template <int Dim, class Shape>
void interpolate_two(benchmark::State& timer) {
  FullTile<Dim, Shape> tile;
  tile.time(timer, [&](const auto& w) {
    Octet at = interpolate(w, tile.motion);
    benchmark::DoNotOptimize(at);
  });
}

template <int Dim, class Shape>
void scatter_momentum(benchmark::State& timer) {
  FullTile<Dim, Shape> tile;
  tile.time(timer, [&](const auto& w) { scatter(w, Quad(1e-9), tile.sums); });
}

template <int Dim, class Shape>
void scatter_force(benchmark::State& timer) {
  FullTile<Dim, Shape> tile;
  Quad flux[Dim];
  for (Quad& column : flux) column = Quad(1e-9);
  tile.time(timer, [&](const auto& w) { scatter_gradient(w, flux, Quad(1e-9), tile.sums); });
}

/// Times f(particles, domain, scratch, window) for a tile of particles in their order, which have moved on since by up to so many cells.
template <class Node, class F>
void add_to_nodes(benchmark::State& timer, double moved, F f) {
  RandomTile<3, Quadratic> tile(8 * power(tile_edge, 3), moved, Quadratic());
  Node window[TileLayout<3, Quadratic>::n_window] = {};
  for (auto _ : timer) {
    f(tile.points(), tile.domain, tile.s, window);
    benchmark::ClobberMemory();
  }
  timer.counters["ns"] = ns_per_item(tile.points().size());
}

/// Times f(tile), which takes numbers from the nodes of a full tile to its particles.
template <class F>
void take_from_nodes(benchmark::State& timer, F f) {
  RandomTile<3, Quadratic> tile(8 * power(tile_edge, 3), 0, Quadratic());
  std::vector<double> velocity(std::size_t(3 * tile.points().size()));
  for (int a = 0; a < 3; ++a) tile.s.velocity[a] = velocity.data() + a * tile.points().size();
  for (auto _ : timer) {
    f(tile);
    benchmark::ClobberMemory();
  }
  timer.counters["ns"] = ns_per_item(tile.points().size());
}
template <class Nodes>
void take_gradients(benchmark::State& timer) {
  take_from_nodes(timer, [](auto& tile) {
    find_gradients(tile.points(), tile.domain, Nodes(tile.tiles[0], tile.velocity.data()), tile.s);
  });
}
template <class Nodes>
void take_accelerations(benchmark::State& timer) {
  take_from_nodes(timer, [](auto& tile) {
    const GridVelocity<3> before{tile.s.velocity[0], tile.s.velocity[1], tile.s.velocity[2]};
    benchmark::DoNotOptimize(
        advance(tile.points(), tile.domain, 0, 1, Nodes(tile.tiles[0], tile.acceleration.data()), before));
  });
}

const bool transfers_registered = [] {
  const auto add = [](const std::string& name, auto f) {
    benchmark::RegisterBenchmark(name.c_str(), f)->Repetitions(n_repetitions)->MinTime(0.05);
  };
  for (const double moved : {0.0, 0.1}) {
    const auto add_both = [&]<class Node>(std::type_identity<Node>, const std::string& what, auto one, auto runs) {
      const std::string after = moved > 0 ? ", moved on" : "";
      add("transfer/" + what + "/one by one, 3D" + after, [=](auto& timer) { add_to_nodes<Node>(timer, moved, one); });
      add("transfer/" + what + "/run by run, 3D" + after, [=](auto& timer) { add_to_nodes<Node>(timer, moved, runs); });
    };
    add_both(
        std::type_identity<MassMomentum>(), "mass and momentum",
        [](const auto& points, const auto& domain, const auto&, auto* window) {
          add_mass_and_momentum(points, domain, window);
        },
        [](const auto& points, const auto& domain, const auto&, auto* window) {
          add_mass_and_momentum_in_runs(points, domain, window);
        });
    add_both(
        std::type_identity<ForceStiffness>(), "forces",
        [](const auto& points, const auto& domain, const auto& s, auto* window) {
          add_forces<false>(points, domain, s, window);
        },
        [](const auto& points, const auto& domain, const auto& s, auto* window) {
          add_forces_in_runs<false>(points, domain, s, window);
        });
  }
  add("transfer/gradient/one by one, 3D", take_gradients<WindowNodes<3, Quadratic, MassVelocity>>);
  add("transfer/gradient/from pieces, 3D", take_gradients<SplinePieces<3>>);
  add("transfer/acceleration/one by one, 3D", take_accelerations<WindowNodes<3, Quadratic, Acceleration>>);
  add("transfer/acceleration/from pieces, 3D", take_accelerations<SplinePieces<3>>);
  add("transfer/gradient/quadratic, 2D", gather_gradient<2, Quadratic>);
  add("transfer/gradient/quadratic, 3D", gather_gradient<3, Quadratic>);
  add("transfer/interpolate two fields/quadratic, 2D", interpolate_two<2, Quadratic>);
  add("transfer/interpolate two fields/quadratic, 3D", interpolate_two<3, Quadratic>);
  add("transfer/scatter/quadratic, 2D", scatter_momentum<2, Quadratic>);
  add("transfer/scatter/quadratic, 3D", scatter_momentum<3, Quadratic>);
  add("transfer/scatter gradient/quadratic, 2D", scatter_force<2, Quadratic>);
  add("transfer/scatter gradient/quadratic, 3D", scatter_force<3, Quadratic>);
  return true;
}();

}  // namespace
}  // namespace talus
