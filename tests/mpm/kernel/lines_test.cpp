/// Eight particles at a time: the same bits as one after the other.

#include "talus/mpm/kernel/lines.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "mpm/by_hand.hpp"
#include "talus/backend/backend.hpp"
#include "talus/mpm/cell_order.hpp"
#include "talus/mpm/kernel/force.hpp"
#include "talus/mpm/kernel/mass_and_momentum.hpp"

namespace talus::lines_test {

/// Particles anywhere in the tile at the origin and up to 0.4 cells beside it, in the order of lines, some of them moved on
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

template <class Kind>
class Lines : public testing::Test {};
using Kinds = testing::Types<Of<2, Quadratic>, Of<3, Quadratic>, Of<3, UgimpOf<2>>>;
TYPED_TEST_SUITE(Lines, Kinds);

/// Calls f(tile) for tiles full of particles and with few of them, in order and moved on.
template <class Kind, class F>
void for_tiles(F f) {
  constexpr int Dim = Kind::dim;
  using Shape = typename Kind::shape;
  for (const int n : {1, 7, 130})
    for (const double moved : {0.0, 0.1, 0.4}) {
      RandomTile<Dim, Shape> tile(n, moved, Shape());
      SCOPED_TRACE(testing::Message() << n << " particles, moved by " << moved);
      f(tile);
    }
}

TYPED_TEST(Lines, GradientsHaveTheBitsOfSingleParticles) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  for_tiles<TypeParam>([](auto& tile) {
    MassVelocity window[TileLayout<Dim, Shape>::n_window];
    fill_window<Dim, Shape>(tile.tiles[0], tile.velocity.data(), window);
    NodeRows<Dim, Shape, Dim> rows;
    fill_rows<0>(tile.tiles[0], tile.velocity.data(), rows);
    const auto points = tile.points();
    find_gradients(points, tile.domain, window, tile.s);
    std::vector<double> expected;
    for (int i = 0; i < points.size(); ++i)
      for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b) expected.push_back(std::exchange(tile.s.gradient[a][b][i], rubbish));
    find_gradients(points, tile.domain, rows, tile.s);
    std::vector<double> found;
    for (int i = 0; i < points.size(); ++i)
      for (int a = 0; a < Dim; ++a)
        for (int b = 0; b < Dim; ++b) found.push_back(tile.s.gradient[a][b][i]);
    EXPECT_EQ(found, expected);
  });
}

TYPED_TEST(Lines, NewVelocitiesAndPlacesHaveTheBitsOfSingleParticles) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  for_tiles<TypeParam>([](auto& tile) {
    NodeMotion window[TileLayout<Dim, Shape>::n_window];
    fill_window<Dim, Shape>(tile.tiles[0], tile.velocity.data(), tile.acceleration.data(), window);
    NodeRows<Dim, Shape, 2 * Dim> rows;
    fill_rows<0>(tile.tiles[0], tile.velocity.data(), rows);
    fill_rows<Dim>(tile.tiles[0], tile.acceleration.data(), rows);
    auto& p = tile.bodies[0].particles;
    const auto columns = [&](auto f) {
      for (int a = 0; a < Dim; ++a)
        for (double* column : {p.position(a), p.velocity(a)})
          for (int i = 0; i < p.size(); ++i) f(column[i]);
    };
    std::vector<double> before, expected, found;
    columns([&](double x) { before.push_back(x); });
    const double fastest = advance<Advance::both>(tile.points(), tile.domain, 0.01, 0.7, window);
    columns([&, i = 0](double& x) mutable { expected.push_back(std::exchange(x, before[std::size_t(i++)])); });
    EXPECT_EQ(advance<Advance::both>(tile.points(), tile.domain, 0.01, 0.7, rows), fastest);
    columns([&](double x) { found.push_back(x); });
    EXPECT_EQ(found, expected);
  });
}

/// Rows for velocities of n particles, with one number more each that stays what it was.
template <int Dim>
struct VelocityRows {
  std::vector<double> numbers;
  int n;

  VelocityRows(int count, ScratchView& s) : numbers(std::size_t(Dim * (count + 1)), rubbish), n(count) {
    for (int a = 0; a < Dim; ++a) s.velocity[a] = numbers.data() + a * (n + 1);
  }
  GridVelocity<Dim> view() const {
    GridVelocity<Dim> rows;
    for (int a = 0; a < Dim; ++a) rows[std::size_t(a)] = numbers.data() + a * (n + 1);
    return rows;
  }
};

TYPED_TEST(Lines, VelocitiesOfTheGridAtParticlesHaveTheBitsOfSingleOnesAndNothingIsWrittenBehind) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  for_tiles<TypeParam>([](auto& tile) {
    MassVelocity window[TileLayout<Dim, Shape>::n_window];
    fill_window<Dim, Shape>(tile.tiles[0], tile.velocity.data(), window);
    NodeRows<Dim, Shape, Dim> rows;
    fill_rows<0>(tile.tiles[0], tile.velocity.data(), rows);
    const auto points = tile.points();
    VelocityRows<Dim> one(points.size(), tile.s);
    find_gradients(points, tile.domain, window, tile.s);
    VelocityRows<Dim> eight(points.size(), tile.s);
    find_gradients(points, tile.domain, rows, tile.s);
    EXPECT_EQ(eight.numbers, one.numbers);
    for (int i = 0; i < points.size(); ++i) {
      const auto w = weights_of(points, tile.domain, i, 1);
      const Quad v = interpolate(ParticleWeights<Dim, Shape>{w, 0}, window);
      for (int a = 0; a < Dim; ++a) EXPECT_EQ(one.view()[std::size_t(a)][i], v[a]) << i;
    }
    for (int a = 0; a < Dim; ++a) EXPECT_EQ(one.view()[std::size_t(a)][points.size()], rubbish);
  });
}

TYPED_TEST(Lines, AccelerationsAndTheVelocityBeforeMoveParticlesAsNewVelocitiesDo) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  constexpr int n_window = TileLayout<Dim, Shape>::n_window;
  for_tiles<TypeParam>([](auto& tile) {
    const double dt = 0.01, alpha = 0.7;
    std::vector<MassVelocity> after;  // v + dt a
    for (std::size_t i = 0; i < tile.velocity.size(); ++i)
      after.push_back(node_of<MassVelocity>(load_node(tile.velocity[i]) + Quad(dt) * load_node(tile.acceleration[i])));
    MassVelocity velocity[n_window];
    Acceleration acceleration[n_window];
    NodeMotion motion[n_window];
    NodeRows<Dim, Shape, Dim> rows;
    fill_window<Dim, Shape>(tile.tiles[0], tile.velocity.data(), velocity);
    fill_window<Dim, Shape>(tile.tiles[0], tile.acceleration.data(), acceleration);
    fill_window<Dim, Shape>(tile.tiles[0], after.data(), tile.acceleration.data(), motion);
    fill_rows<0>(tile.tiles[0], tile.acceleration.data(), rows);
    auto& p = tile.bodies[0].particles;
    VelocityRows<Dim> before(p.size(), tile.s);
    find_gradients(tile.points(), tile.domain, velocity, tile.s);

    const auto columns = [&](auto f) {
      for (int a = 0; a < Dim; ++a)
        for (double* column : {p.position(a), p.velocity(a)})
          for (int i = 0; i < p.size(); ++i) f(column[i]);
    };
    std::vector<double> start;
    columns([&](double x) { start.push_back(x); });
    const auto moved = [&](auto move) {
      std::vector<double> ends{move()};
      columns([&, i = 0](double& x) mutable { ends.push_back(std::exchange(x, start[std::size_t(i++)])); });
      return ends;
    };
    const auto one = moved([&] { return advance(tile.points(), tile.domain, dt, alpha, acceleration, before.view()); });
    const auto eight = moved([&] { return advance(tile.points(), tile.domain, dt, alpha, rows, before.view()); });
    EXPECT_EQ(eight, one);
    const auto direct = moved([&] { return advance<Advance::both>(tile.points(), tile.domain, dt, alpha, motion); });
    for (std::size_t i = 0; i < direct.size(); ++i) EXPECT_NEAR(one[i], direct[i], 1e-14 * (1 + std::abs(direct[i])));
  });
}

template <class Node, int n>
void expect_same(const Node (&found)[n], const Node (&expected)[n]) {
  for (int i = 0; i < n; ++i)
    for (int k = 0; k < 4; ++k) EXPECT_EQ(load_node(found[i])[k], load_node(expected[i])[k]) << i << ", number " << k;
}

TYPED_TEST(Lines, MassMomentumAndForcesAtNodesHaveTheBitsOfSingleParticles) {
  constexpr int Dim = TypeParam::dim;
  using Shape = typename TypeParam::shape;
  constexpr int n = TileLayout<Dim, Shape>::n_window;
  for_tiles<TypeParam>([](auto& tile) {
    // They are added to what is there.
    MassMomentum momentum[n], of_lines[n];
    for (int i = 0; i < n; ++i) momentum[i] = of_lines[i] = node_of<MassMomentum>(tile.numbers());
    add_mass_and_momentum(tile.points(), tile.domain, momentum);
    add_mass_and_momentum_in_lines(tile.points(), tile.domain, of_lines);
    expect_same(of_lines, momentum);
    ForceStiffness forces[n], forces_of_lines[n];
    for (int i = 0; i < n; ++i) forces[i] = forces_of_lines[i] = node_of<ForceStiffness>(tile.numbers());
    add_forces<false>(tile.points(), tile.domain, tile.s, forces);
    add_forces_in_lines<false>(tile.points(), tile.domain, tile.s, forces_of_lines);
    expect_same(forces_of_lines, forces);
  });
}

TEST(LinesAroundAnAxis, HoopRatesAndForcesHaveTheBitsOfSingleParticles) {
  RandomTile<2, Quadratic> tile(50, 0.1, Quadratic(), true);
  constexpr int n = TileLayout<2, Quadratic>::n_window;
  MassVelocity window[n];
  fill_window<2, Quadratic>(tile.tiles[0], tile.velocity.data(), window);
  NodeRows<2, Quadratic, 2> velocity;
  fill_rows<0>(tile.tiles[0], tile.velocity.data(), velocity);
  find_gradients(tile.points(), tile.domain, window, tile.s);
  const std::vector<double> rates(tile.s.gradient[2][2], tile.s.gradient[2][2] + 64);
  std::fill_n(tile.s.gradient[2][2], 64, rubbish);
  find_gradients(tile.points(), tile.domain, velocity, tile.s);
  for (int i = 0; i < 64; ++i) EXPECT_EQ(tile.s.gradient[2][2][i], rates[std::size_t(i)]) << i;
  ForceStiffness expected[n] = {}, found[n] = {};
  add_forces<true>(tile.points(), tile.domain, tile.s, expected);
  add_forces_in_lines<true>(tile.points(), tile.domain, tile.s, found);
  expect_same(found, expected);
}

}  // namespace talus::lines_test
