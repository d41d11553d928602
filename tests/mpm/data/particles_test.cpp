/// Particles: what is stored of them, and where.

#include "talus/mpm/data/particles.hpp"

#include <gtest/gtest.h>

#include <set>

#include "law/parameter_sets.hpp"
#include "talus/law/registry.hpp"

namespace talus::particles_test {

TEST(ParticleLayout, FollowsFromWhatAParticleRemembers) {
  // place, velocity, mass, volume, id: 2 + 2 + 3 in 2D, 3 + 3 + 3 in 3D
  EXPECT_EQ(ParticleLayout(2, {}).n_columns(), 7);
  EXPECT_EQ(ParticleLayout(3, {}).n_columns(), 9);
  EXPECT_EQ(ParticleLayout(3, {7}).n_columns(), 9 + 7) << "state of the law";
  EXPECT_EQ(ParticleLayout(3, {7, true}).n_columns(), 9 + 7 + 9) << "moment of apic";
  EXPECT_EQ(ParticleLayout(2, {0, false, true}).n_columns(), 7 + 4) << "gradient of tpic";
  EXPECT_EQ(ParticleLayout(2, {0, false, false, true}).n_columns(), 7 + 1) << "wave modulus of musl";
  EXPECT_EQ(ParticleLayout(2, {0, false, false, false, 3}).n_columns(), 7 + 3) << "loaded areas";
}

TEST(ParticleIds, AreKeptInOneNumberUpToTheLastOf32Bits) {
  Particles<3> p({});
  p.resize(2);
  p.set_id(0, 7);
  EXPECT_EQ(p.id(0), 7);
  EXPECT_EQ(p.ancestor(0), 7) << "a particle of the start";
  p.set_ids(1, ParticleIds::most, 4'294'967'294);
  EXPECT_EQ(p.id(1), 4'294'967'295);
  EXPECT_EQ(p.ancestor(1), 4'294'967'294);
  EXPECT_THROW(p.set_id(0, ParticleIds::most + 1), std::length_error);
  EXPECT_EQ(p.id(0), 7);
}

TEST(ParticleLayout, EveryColumnBelongsToOneField) {
  const ParticleLayout layout(3, {5, true, false, true, 2});
  int next = 0;
  for (int f = 0; f < n_particle_fields; ++f) {
    EXPECT_EQ(layout.begin(ParticleField(f)), next) << particle_fields[f].name;
    next += layout.components(ParticleField(f));
  }
  EXPECT_EQ(next, layout.n_columns());
  EXPECT_EQ(layout.components(ParticleField::state), 5);
  EXPECT_EQ(layout.components(ParticleField::velocity_gradient), 0);
}

TEST(ParticleLayout, TheMomentOfApicAndTheGradientOfTpicHaveOneName) {
  Particles<2> apic({3, true, false}), tpic({3, false, true});
  apic.resize(1);
  tpic.resize(1);
  for (Particles<2>* p : {&apic, &tpic})
    EXPECT_EQ(p->affine(1, 0), p->columns().column(7 + 3 + 2)) << "row 1, column 0, after the state";
}

TEST(Particles, KeepTheirRowsWhenTheyGrowAndNewOnesHoldZeros) {
  Particles<2> p({2});
  p.resize(1);
  p.mass()[0] = 5;
  p.state(1)[0] = 6;
  p.resize(3);
  EXPECT_EQ(p.mass()[0], 5);
  EXPECT_EQ(p.state(1)[0], 6);
  EXPECT_EQ(p.mass()[2], 0);
}

TEST(Particles, AreAtMostAsManyAsARowNumberHolds) {
  Particles<2> p({2});
  EXPECT_THROW(p.resize(std::size_t(1) << 31), std::length_error);
  EXPECT_EQ(p.size(), 0);
}

TEST(Particles, TheNamesOfFieldsDiffer) {
  std::set<std::string_view> names;
  for (const auto& field : particle_fields) names.insert(field.name);
  EXPECT_EQ(int(names.size()), n_particle_fields);
}

TEST(Particles, PlacesOfFewerThanFourRepeatTheLast) {
  Particles<2> p({});
  p.resize(3);
  for (int i = 0; i < 3; ++i) {
    p.position(0)[i] = i;
    p.position(1)[i] = 10 * i;
  }
  const FourPlaces<2> x = p.view().places(1, 2);
  EXPECT_EQ(x[0][0], 1);
  EXPECT_EQ(x[0][1], 2);
  EXPECT_EQ(x[0][3], 2);
  EXPECT_EQ(x[1][3], 20);
}

TEST(Particles, StatesOfAPackAreThoseOfItsParticlesOneByOne) {
  using Law = Granular;
  constexpr int n = 5;  // fewer than a pack
  Particles<3> p({state_size<Law>});
  p.resize(n);
  for (int k = 0; k < state_size<Law>; ++k)
    for (int i = 0; i < n; ++i) p.state(k)[i] = 100 * k + i;
  using State = Law::State<Pack>;
  const State pack = load_states<Pack, State>(p.view(), 0, n);
  for (int i = 0; i < n; ++i) {
    const auto one = state_of<Law>(p, i);
    for (int k = 0; k < state_size<Law>; ++k) {
      EXPECT_EQ(numbers_of<Pack>(pack)[k][i], 100 * k + i);
      EXPECT_EQ(numbers_of<double>(one)[k], 100 * k + i);
    }
  }
  Particles<3> copy({state_size<Law>});
  copy.resize(n + 1);
  for (int k = 0; k < state_size<Law>; ++k) copy.state(k)[n] = -1;
  store_states<Pack>(copy.view(), 0, n, pack);
  for (int k = 0; k < state_size<Law>; ++k) {
    for (int i = 0; i < n; ++i) EXPECT_EQ(copy.state(k)[i], p.state(k)[i]);
    EXPECT_EQ(copy.state(k)[n], -1) << "the row behind the last stays";
  }
}

}  // namespace talus::particles_test
