/// What the filter of particle velocities keeps and what it takes.

#include "talus/mpm/stage/filter.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "mpm/by_hand.hpp"
#include "talus/backend/backend.hpp"
#include "talus/mpm/arrangement.hpp"

namespace talus::stage_filter_test {

template <int Dim>
using Places = std::vector<Vec<Dim>>;

/// Particles of unit density in an open domain, or one with walls, that a share of 1 of the filter is applied to.
template <int Dim, class Shape>
class Cloud {
 public:
  Cloud(const Places<Dim>& places, const std::function<Vec<Dim>(const Vec<Dim>&)>& velocity,
        const std::array<Wall, 2 * Dim>& walls = {}, double uneven = 0.5)
      : uneven_(uneven), model_(model_of(places, velocity, walls)) {}

  void filter() {
    arrange(model_);
    VelocityFilter<Dim, Shape> filter;
    filter.apply(model_, {0, 0, 1, 1e-12}, 1);
  }

  /// By number, whatever the order in which the particles lie.
  std::vector<Vec<Dim>> velocities() const {
    const Particles<Dim>& p = model_.bodies[0].particles;
    std::vector<Vec<Dim>> all(p.size());
    for (int i = 0; i < p.size(); ++i)
      for (int a = 0; a < Dim; ++a) all[int(p.id(i))][a] = p.velocity(a)[i];
    return all;
  }
  double mass_of(int id) const { return 1 + uneven_ * std::sin(id); }

 private:
  Model<Dim, Shape> model_of(const Places<Dim>& places, const std::function<Vec<Dim>(const Vec<Dim>&)>& velocity,
                             const std::array<Wall, 2 * Dim>& walls) {
    Domain<Dim> domain{};
    domain.h = 0.1;
    domain.walls = walls;
    domain.n_cells.fill(16);
    Particles<Dim> p = particles_at<Dim>(places, {state_size<LinearElastic>});
    for (int i = 0; i < p.size(); ++i) {
      const Vec<Dim> v = velocity(places[i]);
      for (int a = 0; a < Dim; ++a) p.velocity(a)[i] = v[a];
      p.mass()[i] = mass_of(i);
      set_state<LinearElastic>(p, i, {SymTensor<double>::zero(), 1});
    }
    Numerics numerics;
    numerics.transfer = Transfer::affine_tau;
    std::vector<ShapedBody<Dim, Shape>> bodies;
    bodies.push_back({{"cloud", 0.05, LinearElastic{1, 0}, std::move(p), {}}, Shape()});
    return {domain, {}, std::move(bodies), {}, numerics, *backend_};
  }

  double uneven_;
  std::unique_ptr<Backend> backend_ = make_serial();
  Model<Dim, Shape> model_;
};

/// As many places at random in a ball with an arm, so that there are edges, thin parts and single particles.
template <int Dim>
Places<Dim> clump(std::mt19937& random, int n) {
  std::uniform_real_distribution<> anywhere(-1, 1);
  Places<Dim> places;
  while (int(places.size()) < n) {
    Vec<Dim> x;
    double r2 = 0;
    for (int a = 0; a < Dim; ++a) {
      x[a] = anywhere(random);
      r2 += x[a] * x[a];
    }
    if (r2 > 0.16 && !(x[0] > 0 && std::abs(x[1]) < 0.1)) continue;
    for (int a = 0; a < Dim; ++a) x[a] = 0.8 + 0.7 * x[a];
    places.push_back(x);
  }
  return places;
}

using Kinds = testing::Types<Of<2, Linear>, Of<2, Quadratic>, Of<2, Cubic>, Of<2, UgimpOf<2>>, Of<3, Linear>,
                             Of<3, Quadratic>, Of<3, Cubic>>;
template <class Kind>
class AffineFilters : public testing::Test {};
TYPED_TEST_SUITE(AffineFilters, Kinds);

TYPED_TEST(AffineFilters, KeepEveryAffineMotionAtEdgesAsInside) {
  constexpr int Dim = TypeParam::dim;
  std::mt19937 random(1);
  Cloud<Dim, typename TypeParam::shape> cloud(clump<Dim>(random, 300), [](const Vec<Dim>& x) {
    Vec<Dim> v;
    for (int a = 0; a < Dim; ++a) v[a] = 1 + a + (2 - a) * x[0] + (3 * a - 1) * x[1] - a * x[Dim - 1];
    return v;
  });
  const auto before = cloud.velocities();
  cloud.filter();
  const auto after = cloud.velocities();
  // To rounding, but around nodes whose few particles lie in a plane within 1/1000 of a cell: of a slope of 5/s they may
  // lose what it is over 0.1 mm, 5e-4 m/s.
  int exact = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    for (int a = 0; a < Dim; ++a) {
      EXPECT_NEAR(after[i][a], before[i][a], 5e-4);
      exact += std::abs(after[i][a] - before[i][a]) < 1e-9;
    }
  EXPECT_GT(exact, 0.95 * Dim * double(before.size()));
}

TYPED_TEST(AffineFilters, TakeEnergyAndNeitherMomentumNorAngularMomentum) {
  constexpr int Dim = TypeParam::dim;
  using CloudOf = Cloud<Dim, typename TypeParam::shape>;
  std::mt19937 random(2);
  const Places<Dim> places = clump<Dim>(random, 300);
  const auto at_random = [&](const Vec<Dim>&) {
    Vec<Dim> v;
    for (int a = 0; a < Dim; ++a) v[a] = std::normal_distribution<>()(random);
    return v;
  };
  CloudOf one(places, at_random), other(places, at_random);
  const auto u = one.velocities(), v = other.velocities();
  one.filter();
  other.filter();
  const auto Fu = one.velocities(), Fv = other.velocities();
  Vec<3> lost{}, lost_angular{};
  double energy = 0, energy_left = 0, uFv = 0, vFu = 0;
  for (int i = 0; i < int(places.size()); ++i) {
    Vec<3> x{}, change{};
    for (int a = 0; a < Dim; ++a) {
      x[a] = places[i][a];
      change[a] = one.mass_of(i) * (Fu[i][a] - u[i][a]);
      energy += one.mass_of(i) * u[i][a] * u[i][a];
      energy_left += one.mass_of(i) * Fu[i][a] * Fu[i][a];
      uFv += one.mass_of(i) * u[i][a] * Fv[i][a];
      vFu += one.mass_of(i) * v[i][a] * Fu[i][a];
    }
    lost = lost + change;
    lost_angular = lost_angular + cross(x, change);
  }
  for (int a = 0; a < 3; ++a) {
    EXPECT_NEAR(lost[a], 0, 1e-12 * energy);
    EXPECT_NEAR(lost_angular[a], 0, 1e-9 * energy);
  }
  EXPECT_NEAR(uFv, vFu, 1e-9 * energy) << "a symmetric filter: with eigenvalues from 0 to 1 it can only take energy";
  EXPECT_LT(energy_left, 0.7 * energy);
  EXPECT_GT(energy_left, 0.01 * energy);
}

TEST(AffineFilter, LeavesAParticleAloneAndTwoAndARowThatStretches) {
  // One particle is any field, two are a field that varies along their line; of three in a row what bends is taken.
  const auto stretch = [](const Vec<2>& x) { return Vec<2>{5 * x[0], -3 * x[0]}; };
  for (const Places<2>& places : {Places<2>{{0.8, 0.8}}, Places<2>{{0.8, 0.8}, {0.83, 0.81}},
                                  Places<2>{{0.75, 0.8}, {0.8, 0.8}, {0.85, 0.8}}, Places<2>{{0.8, 0.8}, {0.8, 0.8}}}) {
    Cloud<2, Quadratic> cloud(places, stretch);
    const auto before = cloud.velocities();
    cloud.filter();
    const auto after = cloud.velocities();
    for (std::size_t i = 0; i < before.size(); ++i)
      for (int a = 0; a < 2; ++a) EXPECT_NEAR(after[i][a], before[i][a], 1e-9) << places.size();
  }
  // By hand, of equal masses half a cell apart, the middle one on a node: N there is 1/2, 3/4, 1/2, the mean 3/7 and the
  // slope 0; of the nodes beside it each sees two particles and fits them. 3/4 3/7 + 2/8 = 4/7.
  Cloud<2, Quadratic> bent(
      {{0.75, 0.8}, {0.8, 0.8}, {0.85, 0.8}},
      [](const Vec<2>& x) {
        return Vec<2>{0, std::abs(x[0] - 0.8) < 0.01 ? 1.0 : 0.0};
      },
      {}, 0);
  bent.filter();
  EXPECT_NEAR(bent.velocities()[1][1], 4.0 / 7, 1e-12);
  // Two at one place share their velocity: they are no field.
  int number = 0;
  Cloud<2, Quadratic> pair({{0.8, 0.8}, {0.8, 0.8}}, [&](const Vec<2>&) { return Vec<2>{double(number++), 0}; });
  pair.filter();
  const double mean = pair.mass_of(1) / (pair.mass_of(0) + pair.mass_of(1));
  for (const auto& v : pair.velocities()) EXPECT_NEAR(v[0], mean, 1e-12);
}

TEST(AffineFilter, KeepsBesideAWallWhatTheWallAllows) {
  // Simple shear over a floor that holds; stretching along a smooth one, with what comes in across it; and no velocity
  // towards either.
  Places<2> layer;
  for (int i = 0; i < 16; ++i)
    for (int j = 0; j < 6; ++j) layer.push_back({0.4 + 0.05 * i, 0.025 + 0.05 * j});
  const auto kept = [&](WallKind floor, const std::function<Vec<2>(const Vec<2>&)>& velocity) {
    Cloud<2, Quadratic> cloud(layer, velocity, {WallKind::open, WallKind::open, floor, WallKind::open});
    const auto before = cloud.velocities();
    cloud.filter();
    const auto after = cloud.velocities();
    double most = 0;
    for (std::size_t i = 0; i < before.size(); ++i)
      for (int a = 0; a < 2; ++a) most = std::max(most, std::abs(after[i][a] - before[i][a]));
    return most < 1e-12;
  };
  const auto shear = [](const Vec<2>& x) { return Vec<2>{3 * x[1], -x[1]}; };
  const auto stretch = [](const Vec<2>& x) { return Vec<2>{1 + 3 * x[0], -3 * x[1]}; };
  const auto slide = [](const Vec<2>&) { return Vec<2>{1, 0}; };
  const auto fall = [](const Vec<2>&) { return Vec<2>{0, -1}; };
  EXPECT_TRUE(kept(WallKind::no_slip, shear));
  EXPECT_FALSE(kept(WallKind::no_slip, slide));
  EXPECT_FALSE(kept(WallKind::no_slip, fall));
  EXPECT_TRUE(kept(WallKind::slip, stretch));
  EXPECT_TRUE(kept(WallKind::symmetry, slide));
  EXPECT_FALSE(kept(WallKind::symmetry, fall));
  EXPECT_TRUE(kept(WallKind::open, fall));
}

TEST(AffineFilter, HoldsTheFitOnASurfaceAcrossItAndWhereFrictionHoldsAlongItToo) {
  // Two kilograms on a node of a floor, on their way along and into it.
  FilterMoments<2> moments{};
  moments.quads[0] = {{2 * 0.3, 2 * -0.1, 0, 2}};
  for (const bool sticks : {false, true}) {
    NodeContact contact{0, Wall(WallKind::friction, 0.5, true), {0, 1, 0}};
    contact.sticks = sticks;
    FilterFit<2> fit = fit_velocity(moments, 1e-9);
    const Vec<3> impulse = hold_fit(contact, moments, 1, Quad(1.0), fit);
    EXPECT_NEAR(load_node(fit.at)[0], sticks ? 0 : 0.3, 1e-15);
    EXPECT_NEAR(load_node(fit.at)[1], 0, 1e-15);
    EXPECT_NEAR(impulse[0], sticks ? -0.6 : 0, 1e-15);
    EXPECT_NEAR(impulse[1], 0.2, 1e-15);
  }
}

}  // namespace talus::stage_filter_test
