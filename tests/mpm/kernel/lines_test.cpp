/// Eight particles at a time: the same bits as one after the other.

#include "talus/mpm/kernel/lines.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "mpm/kernel/for_tiles.hpp"

namespace talus::lines_test {

template <class Kind>
class Lines : public testing::Test {};
using Kinds = testing::Types<Of<2, Quadratic>, Of<3, Quadratic>, Of<3, UgimpOf<2>>>;
TYPED_TEST_SUITE(Lines, Kinds);

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
      for (int a = 0; a < Dim; ++a) EXPECT_NEAR(one.view()[std::size_t(a)][i], v[a], 2e-15) << i;
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

TEST(LinesAroundAnAxis, HoopRatesHaveTheBitsOfSingleParticles) {
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
}

}  // namespace talus::lines_test
