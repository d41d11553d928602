/// The bodies of a case, filled with particles.

#include "talus/mpm/start/body.hpp"

#include <gtest/gtest.h>

#include <numeric>

#include "law/parameter_sets.hpp"
#include "talus/base/error.hpp"

namespace talus::start_body_test {

/// A block of rubber (2000 kg/m3, E = 8 MPa, nu = 0) of 1 m x 0.5 m, and 0.25 m deep in 3D, of eight particles that are
/// 0.25 m wide.
Case block(int dim = 2) {
  Case what;
  what.dim = dim;
  what.domain = {{0, 0, 0}, {4, 4, 4}};
  what.cell = 0.5;
  what.materials = {{"rubber", LinearElastic{{8e6, 0}}, 2000}};
  BodySpec body;
  body.name = "block";
  body.region = Box{{0, 0, 0}, {1, 0.5, dim == 3 ? 0.25 : 0}};
  body.spacing = 0.25;
  what.bodies = {body};
  return what;
}

template <int Dim = 2>
Body<Dim> made(const Case& what, long first_id = 0) {
  return make_body<Dim>(what, 0, Overburden(what), first_id);
}

/// What is wrong with the body, in words.
std::string complaint(const Case& what) {
  try {
    made(what);
  } catch (const InputError& e) {
    return e.what();
  }
  return "";
}
void expect_in(const std::string& part, const std::string& text) {
  EXPECT_NE(text.find(part), std::string::npos) << "no \"" << part << "\" in: " << text;
}

TEST(StartOfABody, ItsParticlesShareItsMassAndAreNumberedFromTheFirstIdOn) {
  // 2000 kg/m3 times 0.25 m x 0.25 m, and times 0.25 m in 3D.
  const Body<2> flat = made<2>(block(2), 10);
  const Body<3> deep = made<3>(block(3), 10);
  ASSERT_EQ(flat.particles.size(), 8);
  ASSERT_EQ(deep.particles.size(), 8);
  for (int i = 0; i < 8; ++i) {
    EXPECT_EQ(flat.particles.id(i), 10 + i);
    EXPECT_NEAR(flat.particles.mass()[i], 125, 1e-12);
    EXPECT_NEAR(flat.particles.reference_volume()[i], 0.0625, 1e-16);
    EXPECT_NEAR(deep.particles.mass()[i], 31.25, 1e-13);
    EXPECT_NEAR(deep.particles.position(2)[i], 0.125, 1e-16);
  }
  EXPECT_EQ(flat.name, "block");
  EXPECT_EQ(flat.spacing, 0.25);
}

TEST(StartOfABody, AParticleOfSandRemembersTheVolumeOfItsGrains) {
  // Void ratio 0.6: 1/1.6 of the volume is grains, of 2500 kg/m3.
  Case what = block();
  what.materials = {{"sand", case_1(), 0}};
  what.bodies[0].void_ratio = 0.6;
  const Body<2> sand = made(what);
  for (int i = 0; i < 8; ++i) {
    EXPECT_NEAR(sand.particles.reference_volume()[i], 0.0625 / 1.6, 1e-16);
    EXPECT_NEAR(sand.particles.mass()[i], 2500 * 0.0625 / 1.6, 1e-12);
  }
}

TEST(StartOfABody, ItTurnsAboutTheMiddleOfItsMass) {
  // (3, 4) m/s and 2 rad/s about (0.5, 0.25): at a distance r, v = (3 - 2 r_y, 4 + 2 r_x).
  Case what = block();
  what.bodies[0].velocity = {3, 4, 0};
  what.bodies[0].angular_velocity = {0, 0, 2};
  const Body<2> body = made(what);
  const Particles<2>& p = body.particles;
  for (int i = 0; i < p.size(); ++i) {
    EXPECT_NEAR(p.velocity(0)[i], 3 - 2 * (p.position(1)[i] - 0.25), 1e-14);
    EXPECT_NEAR(p.velocity(1)[i], 4 + 2 * (p.position(0)[i] - 0.5), 1e-14);
  }
  EXPECT_NEAR(p.velocity(0)[0], 3.25, 1e-14) << "at (0.125, 0.125)";
  EXPECT_NEAR(p.velocity(1)[0], 3.25, 1e-14);
}

TEST(StartOfABody, ItsLawHasTheStiffnessThatTheRunGoesOnWith) {
  // E = 8 MPa by a factor of 1/4, which with nu = 0 is the modulus of waves: 2 MPa in 1/16 m3.
  Case what = block();
  what.numerics.stiffness_factor = 0.25;
  what.numerics.order = Order::musl;
  const Body<2> body = made(what);
  EXPECT_DOUBLE_EQ(std::get<LinearElastic>(body.law).E, 2e6);
  for (int i = 0; i < 8; ++i) EXPECT_NEAR(body.particles.wave_modulus()[i], 125e3, 1e-9);
}

TEST(StartOfABody, ALoadActsOnItsSideOfItsBodyOnly) {
  // Of the top, 1 m, each of the four upper particles has a quarter.
  Case what = block();
  what.bodies.push_back(what.bodies[0]);
  what.loads.resize(2);
  what.loads[0] = {"elsewhere", 1, 3, {0, -1, 0}, {}};
  what.loads[1] = {"here", 0, 3, {0, -1, 0}, {}};
  const Body<2> body = made(what);
  ASSERT_EQ(body.loads.size(), 1u);
  EXPECT_EQ(body.loads[0].name, "here");
  const Particles<2>& p = body.particles;
  for (int i = 0; i < p.size(); ++i) EXPECT_NEAR(p.loaded_area(0)[i], p.position(1)[i] > 0.25 ? 0.25 : 0, 1e-15) << i;
}

TEST(StartOfABody, WithoutParticlesOrRestOrASideToLoadItIsRefused) {
  EXPECT_EQ(complaint(block()), "");
  Case coarse = block(), torn = block(), missed = block();
  coarse.bodies[0].spacing = 3;
  expect_in("body `block` has no particles", complaint(coarse));
  torn.materials = {{"sand", case_1(), 0}};
  torn.bodies[0].void_ratio = 0.8;
  torn.bodies[0].initial_stress = InitialStress::given;
  for (int c = 0; c < 3; ++c) torn.bodies[0].given_stress[c] = 1000;  // tension
  expect_in("body `block` cannot rest under its initial stress: ", complaint(torn));
  missed.loads = {{"foot", 0, 3, {0, -1, 0}, {}, Box{{2, 0, 0}, {3, 4, 0}}}};
  expect_in("load `foot` finds nothing of its side of body `block`", complaint(missed));
}

TEST(StartOfABody, APartHasTheParticlesOfTheWholeWithTheirNumbersAreasAndSpin) {
  Case what = block();
  what.loads = {{"on top", 0, 3, {0, -1, 0}, {}}};
  what.bodies[0].angular_velocity = {0, 0, 2};
  const Body<2> whole = made(what, 10);
  int n = 0;
  for (int number = 0; number < 3; ++number) {
    const Body<2> part = make_body<2>(what, 0, Overburden(what), 10, {number, 3});
    for (int i = 0; i < part.particles.size(); ++i, ++n)
      for (int c = 0; c < whole.particles.columns().n_columns(); ++c)
        EXPECT_EQ(part.particles.columns().column(c)[i], whole.particles.columns().column(c)[n]) << c;
  }
  EXPECT_EQ(n, 8);
  // One of sixteen parts of eight particles has none, which is no mistake.
  EXPECT_EQ(make_body<2>(what, 0, Overburden(what), 10, {0, 16}).particles.size(), 0);
}

TEST(MemoryOfParticles, IsWhatTransferOrderAndLoadsNeed) {
  Numerics n;
  n.transfer = Transfer::apic;
  const ParticleMemory apic = memory_of(n, 7, 2, true);
  EXPECT_EQ(apic.n_state, 7);
  EXPECT_EQ(apic.loads, 2);
  EXPECT_TRUE(apic.moment);
  EXPECT_FALSE(apic.gradient);
  EXPECT_FALSE(apic.modulus);
  n.transfer = Transfer::tpic;
  n.order = Order::musl;
  const ParticleMemory tpic = memory_of(n, 7, 0, true);
  EXPECT_FALSE(tpic.moment);
  EXPECT_TRUE(tpic.gradient);
  EXPECT_TRUE(tpic.modulus);
}

TEST(MemoryOfParticles, IsEstimatedFromTheirNumberAndColumns) {
  // Eight particles of 14 numbers (place 2, velocity 2, mass, volume, id, stress 6, volume ratio) and a snapshot of 21
  // (position is not counted: velocity 3, body, id, ancestor, mass, volume, stress 6, p, q, shear rate, spin 3, volume ratio).
  Case what = block();
  EXPECT_EQ(estimated_bytes(what), 8 * 8 * (14 + 21));
  what.loads = {{"elsewhere", 1, 3, {0, -1, 0}, {}}};
  EXPECT_EQ(estimated_bytes(what), 8 * 8 * (14 + 21));
  what.loads = {{"here", 0, 3, {0, -1, 0}, {}}};
  EXPECT_EQ(estimated_bytes(what), 8 * 8 * (15 + 21)) << "and its area";
  what.numerics.transfer = Transfer::apic;
  EXPECT_EQ(estimated_bytes(what), 8 * 8 * (19 + 21)) << "and four moments of velocity";
  EXPECT_EQ(estimated_bytes(what, 0.5), 8 * 8 * (9.5 + 21)) << "half of the particles, but snapshots of all";
}

}  // namespace talus::start_body_test
