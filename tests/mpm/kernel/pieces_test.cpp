/// What particles interpolate from pieces of splines: that of weights and nodes, one particle after the other.

#include "talus/mpm/kernel/pieces.hpp"

#include <gtest/gtest.h>

#include "mpm/kernel/for_tiles.hpp"

namespace talus::pieces_test {

/// Nodes have numbers of up to 1, in cells of 0.3 m, so errors are some roundings of 1, or of 1/0.3.
constexpr double rounding = 1e-14;

template <class Kind>
class Pieces : public testing::Test {};
using Kinds = testing::Types<Of<2, Quadratic>, Of<3, Quadratic>>;
TYPED_TEST_SUITE(Pieces, Kinds);

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

void expect_near(const std::vector<double>& found, const std::vector<double>& expected) {
  ASSERT_EQ(found.size(), expected.size());
  for (std::size_t i = 0; i < found.size(); ++i)
    EXPECT_NEAR(found[i], expected[i], rounding * (1 + std::abs(expected[i]))) << i;
}

TYPED_TEST(Pieces, GiveVelocitiesAndGradientsOfWeightsAndWriteNothingBehind) {
  constexpr int Dim = TypeParam::dim;
  for_tiles<TypeParam>([](auto& tile) {
    MassVelocity nodes[TileLayout<Dim, Quadratic>::n_window];
    fill_window<Dim, Quadratic>(tile.tiles[0], tile.velocity.data(), nodes);
    const auto points = tile.points();
    const auto found_with = [&](const auto& velocity) {
      VelocityRows<Dim> rows(points.size(), tile.s);
      find_gradients(points, tile.domain, velocity, tile.s);
      for (int a = 0; a < Dim; ++a) EXPECT_EQ(rows.view()[std::size_t(a)][points.size()], rubbish);
      std::vector<double> found = rows.numbers;
      for (int i = 0; i < points.size(); ++i)
        for (int a = 0; a < Dim; ++a)
          for (int b = 0; b < Dim; ++b) found.push_back(std::exchange(tile.s.gradient[a][b][i], rubbish));
      return found;
    };
    expect_near(found_with(SplinePieces<Dim>(tile.tiles[0], tile.velocity.data())), found_with(&nodes[0]));
  });
}

TYPED_TEST(Pieces, MoveParticlesAsWeightsDo) {
  constexpr int Dim = TypeParam::dim;
  constexpr int n_window = TileLayout<Dim, Quadratic>::n_window;
  for_tiles<TypeParam>([](auto& tile) {
    const double dt = 0.01, alpha = 0.7;
    std::vector<MassVelocity> after;  // v + dt a
    for (std::size_t i = 0; i < tile.velocity.size(); ++i)
      after.push_back(node_of<MassVelocity>(load_node(tile.velocity[i]) + Quad(dt) * load_node(tile.acceleration[i])));
    MassVelocity velocity[n_window];
    Acceleration acceleration[n_window];
    NodeMotion motion[n_window];
    fill_window<Dim, Quadratic>(tile.tiles[0], tile.velocity.data(), velocity);
    fill_window<Dim, Quadratic>(tile.tiles[0], tile.acceleration.data(), acceleration);
    fill_window<Dim, Quadratic>(tile.tiles[0], after.data(), tile.acceleration.data(), motion);
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
    const auto of_weights =
        moved([&] { return advance(tile.points(), tile.domain, dt, alpha, acceleration, before.view()); });
    const SplinePieces<Dim> pieces(tile.tiles[0], tile.acceleration.data());
    expect_near(moved([&] { return advance(tile.points(), tile.domain, dt, alpha, pieces, before.view()); }),
                of_weights);
    expect_near(moved([&] { return advance<Advance::both>(tile.points(), tile.domain, dt, alpha, motion); }),
                of_weights);
  });
}

TYPED_TEST(Pieces, MoveParticlesApartAsWeightsDo) {
  constexpr int Dim = TypeParam::dim;
  for_tiles<TypeParam>([](auto& tile) {
    std::vector<Crowding> nodes;
    for (std::size_t i = 0; i < tile.velocity.size(); ++i) nodes.push_back(node_of<Crowding>(tile.numbers()));
    Crowding window[TileLayout<Dim, Quadratic>::n_window];
    fill_window<Dim, Quadratic>(tile.tiles[0], nodes.data(), window);
    auto& p = tile.bodies[0].particles;
    const auto shifted = [&](const auto& crowding) {
      std::vector<double> start, ends;
      for (int a = 0; a < Dim; ++a) start.insert(start.end(), p.position(a), p.position(a) + p.size());
      const auto limit = [](const Vec<3>&, const Vec<3>& shift) { return 0.9 * shift; };
      shift_particles(tile.points(), tile.domain, crowding, 0.01, limit, tile.s);
      for (int a = 0; a < Dim; ++a)
        for (int i = 0; i < p.size(); ++i)
          ends.push_back(std::exchange(p.position(a)[i], start[std::size_t(a * p.size() + i)]));
      for (int i = 0; i < p.size(); ++i) ends.push_back(std::exchange(tile.s.filling[i], rubbish));
      EXPECT_NE(ends[0], start[0]);
      return ends;
    };
    expect_near(shifted(SplinePieces<Dim>(tile.tiles[0], nodes.data())), shifted(&window[0]));
  });
}

/// Sets the velocity of all nodes to f(node), which is counted in the whole grid.
template <int Dim, class F>
void set_nodes(RandomTile<Dim, Quadratic>& tile, F f) {
  constexpr int n_nodes = TileLayout<Dim, Quadratic>::n_nodes;
  for (std::size_t t = 0; t < tile.tiles.size(); ++t)
    for (int i = 0; i < n_nodes; ++i)
      tile.velocity[t * n_nodes + std::size_t(i)] = f(global_node<Dim>(tile.tiles[t].place, i));
}

TEST(PiecesByHand, OfASquareAreThatSquareAndAQuarter) {
  // The weights of a place x in cells are 1/2 (1/2 - r)^2, 3/4 - r^2 and 1/2 (1/2 + r)^2 at n - 1, n and n + 1, with r = x - n. So where
  // nodes have v = x^2, x in cells, there is n^2 + 2 n r + 2 (1/8 + r^2/2) = x^2 + 1/4 between them, and the slope is 2 x.
  const std::vector<Vec<2>> places{{2, 2}, {2.25, 3.25}, {1.75, 2}, {2.5, 2}, {1.5, 1.5}};
  auto p = particles_at<2>(places);
  RandomTile<2, Quadratic> tile(1, 0, Quadratic());
  set_nodes(tile,
            [](const Index<2>& at) { return node<MassVelocity>(at[0] * at[0], at[0] * at[1] * at[1], 0, rubbish); });
  Scratch scratch;
  ScratchView s = scratch.view(p.size());
  VelocityRows<2> rows(p.size(), s);
  const SplinePieces<2> pieces(tile.tiles[0], tile.velocity.data());
  find_gradients(all_in_one_tile<Quadratic>(p), unit_cells<2>(8), pieces, s);
  for (int i = 0; i < p.size(); ++i) {
    const double x = places[std::size_t(i)][0], y = places[std::size_t(i)][1];
    EXPECT_EQ(rows.view()[0][i], x * x + 0.25) << i;
    EXPECT_EQ(rows.view()[1][i], x * (y * y + 0.25)) << i;
    EXPECT_EQ(s.gradient[0][0][i], 2 * x) << i;
    EXPECT_EQ(s.gradient[0][1][i], 0) << i;
    EXPECT_EQ(s.gradient[1][0][i], y * y + 0.25) << i;
    EXPECT_EQ(s.gradient[1][1][i], 2 * x * y) << i;
  }
}

TEST(PiecesByHand, WhatMovesWithoutStrainHasNoStrainRateAtAll) {
  RandomTile<3, Quadratic> tile(130, 0.1, Quadratic());
  set_nodes(tile, [](const Index<3>&) { return node<MassVelocity>(0.1, -0.7, 1.3, rubbish); });
  tile.tiles[0].neighbours[1] = 0;  // it moves as well where there was nothing
  find_gradients(tile.points(), tile.domain, SplinePieces<3>(tile.tiles[0], tile.velocity.data()), tile.s);
  for (int i = 0; i < 130; ++i)
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) EXPECT_EQ(tile.s.gradient[a][b][i], 0);
}

TEST(PiecesAroundAnAxis, GiveHoopRatesOfWeights) {
  RandomTile<2, Quadratic> tile(50, 0.1, Quadratic(), true);
  MassVelocity nodes[TileLayout<2, Quadratic>::n_window];
  fill_window<2, Quadratic>(tile.tiles[0], tile.velocity.data(), nodes);
  find_gradients(tile.points(), tile.domain, nodes, tile.s);
  const std::vector<double> rates(tile.s.gradient[2][2], tile.s.gradient[2][2] + 64);
  std::fill_n(tile.s.gradient[2][2], 64, rubbish);
  find_gradients(tile.points(), tile.domain, SplinePieces<2>(tile.tiles[0], tile.velocity.data()), tile.s);
  expect_near({tile.s.gradient[2][2], tile.s.gradient[2][2] + 64}, rates);
}

}  // namespace talus::pieces_test
