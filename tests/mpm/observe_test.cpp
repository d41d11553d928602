/// What can be seen of a model between two steps.

#include "talus/mpm/observe.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mpm/small_model.hpp"

namespace talus::observe_test {

/// What the owners of a run see together.
template <class AnyModel>
Observation observed(AnyModel& m, double time, long step, bool broken) {
  Observation seen = observe(m, time, step, broken, {});
  gather(m.backend, seen);
  return seen;
}

/// Gives every node the velocity that `velocity` has at its place.
template <class F>
void set_nodes(Model<2, Quadratic>& m, F velocity) {
  for (int t = 0; t < m.grid.n_tiles(); ++t)
    for (int i = 0; i < 16; ++i) {
      const Index<2> place = global_node<2>(m.grid.tile(t).place, i);
      const Vec<2> v = velocity(Vec<2>{double(place[0]), double(place[1])});
      m.grid.velocity.of(t)[i] = node<MassVelocity>(v[0], v[1], 0, 1);
    }
}

TEST(Observe, StrainRatesAreTheSymmetricPartOfTheNodesVelocityGradient) {
  // v = (x + 2 y, 4 x + 3 y); in plane strain nothing happens across the plane.
  SmallModel<> small(unit_cells<2>(16), {{5.3, 6.1}, {9.25, 2.5}});
  auto& m = small.model;
  arrange(m);
  set_nodes(m, [](const Vec<2>& x) { return Vec<2>{x[0] + 2 * x[1], 4 * x[0] + 3 * x[1]}; });
  const double expected[6] = {1, 3, 0, 3, 0, 0};
  const auto rates = strain_rates(m, m.bodies[0]);
  ASSERT_EQ(rates.size(), 2u);
  for (const auto& rate : rates)
    for (int c = 0; c < 6; ++c) EXPECT_NEAR(rate[c], expected[c], 1e-13) << c;
}

TEST(Observe, StrainRatesStandInTheOrderOfRowsAndFieldsInThatOfIds) {
  // v_x = y^2/2: the quadratic spline has its slope y exactly, and shear_rate = |g| = sqrt(2 (y/2)^2 / 2) = y/2.
  SmallModel<> small(unit_cells<2>(16), {{9.5, 9.5}, {1.5, 1.25}});
  auto& m = small.model;
  arrange(m);
  ASSERT_EQ(small.row(1), 0) << "the lower tile comes first";
  set_nodes(m, [](const Vec<2>& x) { return Vec<2>{0.5 * x[1] * x[1], 0}; });
  const auto rates = strain_rates(m, m.bodies[0]);
  EXPECT_NEAR(rates[0].xy, 1.25 / 2, 1e-13);
  EXPECT_NEAR(rates[1].xy, 9.5 / 2, 1e-13);
  const Observation seen = observed(m, 0.25, 7, false);
  EXPECT_EQ(seen.time, 0.25);
  EXPECT_EQ(seen.step, 7);
  EXPECT_EQ(seen.find("id")->values, (std::vector<double>{0, 1}));
  EXPECT_NEAR(seen.find("shear_rate")->values[0], 9.5 / 2, 1e-13);
  EXPECT_NEAR(seen.find("shear_rate")->values[1], 1.25 / 2, 1e-13);
}

TEST(Observe, AfterABreakParticlesAreSeenWhereverTheyStandAndStrainAtNoRate) {
  SmallModel<> small(unit_cells<2>(16), {{5, 6}});
  auto& m = small.model;
  arrange(m);
  set_nodes(m, [](const Vec<2>& x) { return Vec<2>{x[1], 0}; });
  EXPECT_NEAR(observed(m, 0, 0, false).find("shear_rate")->values[0], 0.5, 1e-14);
  small.particles().position(0)[0] = -1e9;
  const Observation seen = observed(m, 0, 0, true);
  EXPECT_EQ(seen.find("position")->values, (std::vector<double>{-1e9, 6, 0}));
  EXPECT_EQ(seen.find("shear_rate")->values[0], 0);
}

TEST(Observe, BodiesAreNumberedInTheirOrderAndShareTheIds) {
  const auto serial = make_serial();
  std::vector<ShapedBody<2, Quadratic>> bodies;
  bodies.push_back({small_body({{1.5, 1.5}, {2.5, 1.5}}), {}});
  bodies.push_back({small_body({{9.5, 9.5}}), {}});
  bodies[0].particles.set_id(1, 2);
  bodies[1].particles.set_id(0, 1);
  Model<2, Quadratic> m(unit_cells<2>(16), {}, std::move(bodies), {}, pure_flip(), *serial);
  arrange(m);
  const Observation seen = observed(m, 0, 0, true);
  EXPECT_EQ(seen.find("body")->values, (std::vector<double>{0, 1, 0}));
  EXPECT_EQ(seen.find("id")->values, (std::vector<double>{0, 1, 2}));
}

TEST(Observe, PlacesAndFlowGoTileByTileAndInEachBodyByBody) {
  // Tiles are four cells wide. Whatever ids say, the first body's particles in a tile come before those of the second one, which
  // has none in the last tile.
  const auto loop = make_threads(2);
  std::vector<ShapedBody<2, Quadratic>> bodies;
  bodies.push_back({small_body({{9.5, 1.5}, {5.5, 1.5}, {2.5, 1.5}}), {}});
  bodies.push_back({small_body({{1.5, 1.5}, {6.5, 1.5}, {3.5, 1.5}}), {}});
  for (std::size_t b = 0; b < 2; ++b)
    for (int i = 0; i < 3; ++i) {
      bodies[b].particles.set_id(i, long(3 * b) + i);
      bodies[b].particles.mass()[i] = double(1 + 3 * b) + i;
      bodies[b].particles.velocity(0)[i] = -bodies[b].particles.position(0)[i];
    }
  Model<2, Quadratic> m(unit_cells<2>(16), {}, std::move(bodies), {}, pure_flip(), *loop);
  arrange(m);
  const ParticlePlaces seen = places_of(m);
  const FlowPoints flow = flow_of(m);
  const std::vector<Vec<3>> places{{2.5, 1.5, 0}, {1.5, 1.5, 0}, {3.5, 1.5, 0},
                                   {5.5, 1.5, 0}, {6.5, 1.5, 0}, {9.5, 1.5, 0}};
  EXPECT_EQ(seen.places, places);
  EXPECT_EQ(seen.ancestors, (std::vector<long>{2, 3, 5, 1, 4, 0}));
  EXPECT_EQ(seen.masses, (std::vector<double>{3, 4, 6, 2, 5, 1}));
  EXPECT_EQ(flow.places, places);
  EXPECT_EQ(flow.masses, seen.masses);
  for (std::size_t i = 0; i < places.size(); ++i) EXPECT_EQ(flow.velocities[i][0], -places[i][0]) << i;
}

TEST(Observe, WhatHasLeftIsNotSeenAndHasNoPlace) {
  // Particle 1 of three has left. The others have volumes of 1 and 4 m3 per metre: squares of 1 and 2 m.
  SmallModel<> small(unit_cells<2>(16), {{1, 1}, {2, 2}, {9, 3}});
  auto& m = small.model;
  auto& p = small.particles();
  p.position(0)[1] = 9;
  p.position(1)[1] = 3;
  p.set_id(1, 2);
  p.reference_volume()[1] = 4;
  p.resize(2);
  m.n_particles = 2;
  arrange(m);
  const Observation seen = observed(m, 0, 0, true);
  EXPECT_EQ(seen.find("id")->values, (std::vector<double>{0, 2}));
  EXPECT_EQ(seen.find("position")->values, (std::vector<double>{1, 1, 0, 9, 3, 0}));
  const ParticlePlaces all = places_of(m);
  ASSERT_EQ(all.sizes.size(), 2u);
  EXPECT_EQ(all.places[1], (Vec<3>{9, 3, 0}));
  EXPECT_NEAR(all.sizes[0], 1, 1e-15);
  EXPECT_NEAR(all.sizes[1], 2, 1e-15);
  EXPECT_EQ(all.ancestors, (std::vector<long>{0, 2})) << "where sizes at the start are found";
}

TEST(Observe, AParticleIsDescribedByItsIdAndOneThatIsNotThereByNothing) {
  SmallModel<> small(unit_cells<2>(16), {{9.5, 9.5}, {1.5, 1.25}});
  arrange(small.model);
  EXPECT_NE(describe_particle(small.model, 0).find("9.5, 9.5 m"), std::string::npos);
  EXPECT_NE(describe_particle(small.model, 1).find("1.5, 1.25 m"), std::string::npos);
  EXPECT_EQ(describe_particle(small.model, 2), "");
}

}  // namespace talus::observe_test
