/// What can be read off the particles of a body.

#include "talus/mpm/inspect.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "law/parameter_sets.hpp"
#include "mpm/by_hand.hpp"
#include "talus/backend/backend.hpp"

namespace talus::inspect_test {

/// Two particles of 2 kg and 3 m3, the second stretched to 6 m3; E = 1000, nu = 1/4.
Body<2> pair() {
  Body<2> body{
      "pair", 1, LinearElastic{1000, 0.25}, particles_at<2>({{1, 2}, {3, 4}}, {state_size<LinearElastic>}), {}};
  for (int i = 0; i < 2; ++i) {
    auto stress = SymTensor<double>::zero();
    stress.xx = -40.0 * i;
    set_state<LinearElastic>(body.particles, i, {stress, 1.0 + i});
    body.particles.mass()[i] = 2;
    body.particles.reference_volume()[i] = 3;
    body.particles.velocity(0)[i] = 5 + i;
  }
  return body;
}

TEST(Inspect, AnObservationHasTheParticlesInTheOrderOfTheirIds) {
  Body<2> body = pair();
  body.particles.set_id(0, 1);
  body.particles.set_id(1, 0);
  const auto loop = make_threads(2);
  Observation seen;
  observe_body(body, 7, std::vector<SymTensor<double>>(2, SymTensor<double>::zero()), *loop, seen);
  gather(*loop, seen);
  EXPECT_EQ(seen.fields[0].name, "position");
  EXPECT_EQ(seen.find("position")->values, (std::vector<double>{3, 4, 0, 1, 2, 0}));
  EXPECT_EQ(seen.find("velocity")->values, (std::vector<double>{6, 0, 0, 5, 0, 0}));
  EXPECT_EQ(seen.find("body")->values, (std::vector<double>{7, 7}));
  EXPECT_EQ(seen.find("volume")->values, (std::vector<double>{6, 3}));
  EXPECT_EQ(seen.find("stress")->values[0], -40);
  EXPECT_NEAR(seen.find("p")->values[0], 40.0 / 3, 1e-14);
  EXPECT_EQ(seen.find("q")->values[1], 0);
  EXPECT_EQ(seen.find("spin"), nullptr) << "of apic only";
}

TEST(Inspect, WhatABodyDoesNotHaveIsNotANumber) {
  Body<2> sand{"sand", 1, case_1(), particles_at<2>({{1, 1}}, {state_size<Granular>}), {}};
  set_state<Granular>(sand.particles, 0, isotropic_state(case_1(), 0, 0.8));
  sand.particles.set_id(0, 2);
  const std::vector<SymTensor<double>> still(2, SymTensor<double>::zero());
  const auto loop = make_serial();
  for (const bool sand_first : {false, true}) {
    Observation seen;
    if (sand_first) observe_body(sand, 0, still, *loop, seen);
    observe_body(pair(), 1, still, *loop, seen);
    if (!sand_first) observe_body(sand, 0, still, *loop, seen);
    gather(*loop, seen);
    ASSERT_EQ(seen.n_particles(), 3);
    const std::vector<double>& ratio = seen.find("void_ratio")->values;
    ASSERT_EQ(ratio.size(), 3u);
    EXPECT_TRUE(std::isnan(ratio[0]) && std::isnan(ratio[1])) << "of sand only";
    EXPECT_NEAR(ratio[2], 0.8, 1e-14);
  }
}

TEST(Inspect, RowsAreInTheOrderOfTheIdsThatAreThere) {
  const RowsOfIds whole({2, 0, 1}), some({7, 3, 12});
  EXPECT_EQ(whole.size(), 3u);
  for (int id = 0; id < 3; ++id) EXPECT_EQ(whole.row(id), std::size_t(id));
  EXPECT_EQ(some.row(3), 0u);
  EXPECT_EQ(some.row(7), 1u);
  EXPECT_EQ(some.row(12), 2u);
}

TEST(Inspect, AParticleIsAsLargeAsTheSquareOfItsVolume) {
  ParticlePlaces plane, around_axis;
  plane.resize(2);
  around_axis.resize(1);
  put_places_of(pair(), {1, 2}, false, plane, 1);
  put_places_of(pair(), {1, 2}, true, around_axis, 0);
  EXPECT_EQ(plane.places, (std::vector<Vec<3>>{{}, {3, 4, 0}})) << "the second one";
  EXPECT_EQ(plane.ancestors[1], 1);
  EXPECT_DOUBLE_EQ(plane.sizes[1], std::sqrt(6.0));
  EXPECT_DOUBLE_EQ(around_axis.sizes[0], std::sqrt(6.0 / 3)) << "per radian, at a radius of 3 m";
}

TEST(Inspect, SprayFlowsWithNoMoreThanTheRoomItMayHave) {
  // 2 kg in 3 and 6 m3; at most 2.5 m3/kg.
  FlowPoints flow;
  flow.resize(2);
  put_flow_of(pair(), {0, 2}, 2.5, 1.25, flow, 0);
  EXPECT_EQ(flow.volumes, (std::vector<double>{3, 5}));
  EXPECT_EQ(flow.volumes_at_start, (std::vector<double>{2.5, 2.5}));
  EXPECT_EQ(flow.velocities, (std::vector<Vec<3>>{{5, 0, 0}, {6, 0, 0}}));
}

/// So many particles in the cells of the tile at the origin in turn; particle i has the volume 1 + i mod 3, the pressure i mod 5
/// and the speed 2.
Body<2> many(int n) {
  std::vector<Vec<2>> places;
  for (int i = 0; i < n; ++i) places.push_back({i % 4 + 0.5, i / 4 % 4 + 0.25});
  Body<2> body{"many", 1, LinearElastic{1000, 0.25}, particles_at<2>(places, {state_size<LinearElastic>}), {}};
  for (int i = 0; i < n; ++i) {
    set_state<LinearElastic>(body.particles, i, {SymTensor<double>::isotropic(-(i % 5)), 1.0 + i % 3});
    body.particles.velocity(1)[i] = 2;
  }
  return body;
}

TEST(Inspect, EveryParticleIsReadAlsoThoseBeyondTheLastFullPackOfTheLastPart) {
  constexpr int n = 256 + 256 + 13;
  ParticlePlaces seen;
  FlowPoints flow;
  seen.resize(n - 1);
  flow.resize(n - 1);
  put_places_of(many(n), {1, n}, false, seen, 0);
  put_flow_of(many(n), {1, n}, 1e9, 1, flow, 0);
  for (int i = 1; i < n; ++i) {
    ASSERT_EQ(seen.ancestors[std::size_t(i - 1)], i);
    ASSERT_EQ(seen.places[std::size_t(i - 1)][0], i % 4 + 0.5);
    ASSERT_DOUBLE_EQ(seen.sizes[std::size_t(i - 1)], std::sqrt(1.0 + i % 3)) << i;
    ASSERT_EQ(seen.masses[std::size_t(i - 1)], 1);
    ASSERT_EQ(flow.volumes[std::size_t(i - 1)], 1 + i % 3);
    ASSERT_EQ(flow.velocities[std::size_t(i - 1)][1], 2);
  }
}

TEST(Inspect, ThePressureInATileIsTheMeanOverVolumeAndScattersWithinCells) {
  constexpr int n = 16 * 15 * 3;
  CellPressures<2> cells;
  cells.add(many(n), {0, n}, unit_cells<2>(16), {0, 0});
  const TilePressure seen = cells.sum({0, 0});
  // Each cell has all 15 pairs of volume and pressure, three times.
  EXPECT_NEAR(seen.volume, 16 * 3 * 15 * 2, 1e-9);
  EXPECT_NEAR(seen.pressure, 2, 1e-13);
  EXPECT_NEAR(seen.scatter, std::sqrt(2), 1e-13) << "the variance of 0, 1, 2, 3, 4 is 2";
  EXPECT_NEAR(seen.speed, 2, 1e-13);
}

TEST(Inspect, ADescriptionNamesTheParticleItsBodyAndItsQuantities) {
  const std::string text = describe(pair(), 1);
  for (const char* part : {"particle 1 of body `pair`", "position", "3, 4 m", "velocity", "6, 0 m/s", "volume_ratio"})
    EXPECT_NE(text.find(part), std::string::npos) << part << " in\n" << text;
}

TEST(Inspect, EnergyIsVolumeTimesItsDensity) {
  // sigma^2/(2 E) = 0.8 J/m3 in 6 m3
  const auto energies = elastic_energies(pair(), {0, 2});
  ASSERT_EQ(energies.size(), 2u);
  EXPECT_EQ(energies[0], 0);
  EXPECT_NEAR(energies[1], 6 * 40 * 40 / 2000.0, 1e-13);
  EXPECT_EQ(elastic_energies(pair(), {1, 2}).size(), 1u);
}

TEST(Inspect, TheLoosestParticleAndTheFastestWaveAreFound) {
  EXPECT_EQ(largest_volume_per_mass(pair()), 3);
  // c^2 = 1200 Pa times volume over mass, 3 m3/kg at the second
  const FastestWave wave = fastest_wave(pair(), {});
  EXPECT_NEAR(wave.speed, std::sqrt(1200.0 * 3), 1e-12);
  EXPECT_EQ(wave.particle, 1);
}

TEST(Inspect, LoadsCouldGiveStressTimesAreaOverMass) {
  Body<2> body = pair();
  Particles<2> p({state_size<LinearElastic>, false, false, false, 1});
  p.resize(2);
  for (int i = 0; i < 2; ++i) {
    p.mass()[i] = 2;
    p.loaded_area(0)[i] = i;
  }
  body.particles = std::move(p);
  SurfaceLoad load;
  load.traction = {3, 4, 0};
  body.loads = {load};
  EXPECT_EQ(largest_acceleration_by_loads(body), 2.5);
  body.loads[0].factor = {{0, 1}, {0.5, -2}};
  EXPECT_EQ(largest_acceleration_by_loads(body), 5) << "at its largest";
}

TEST(Inspect, OnlyWhatStiffensWithStressHasAStiffeningAtContact) {
  EXPECT_FALSE(contact_stiffening(pair()));
  Body<2> sand{"sand", 1, case_1(), particles_at<2>({{1, 1}}, {state_size<Granular>}), {}};
  set_state<Granular>(sand.particles, 0, isotropic_state(case_1(), 0, 0.8));
  EXPECT_TRUE(contact_stiffening(sand));
}

TEST(Inspect, OfASingleOwnerNothingHasToBeGathered) {
  const auto serial = make_serial();
  EXPECT_EQ(gather(*serial, "text"), "text");
}

}  // namespace talus::inspect_test
