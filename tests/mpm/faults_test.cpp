/// Runs that break.

#include "talus/mpm/faults.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "mpm/small_model.hpp"

namespace talus::faults_test {

Ledger at_step_12() {
  Ledger l;
  l.time = 0.5;
  l.step = 12;
  l.dt = 0.001;
  return l;
}
/// What f throws.
template <class F>
std::pair<std::string, long> error_of(F f) {
  try {
    f();
  } catch (const RunError& e) {
    return {e.what(), e.particle().value_or(-1)};
  }
  return {"nothing", -1};
}
void expect_in(const std::string& text, const std::string& all) {
  EXPECT_NE(all.find(text), std::string::npos) << "no \"" << text << "\" in\n" << all;
}

TEST(Faults, AParticleOutsideIsNamedWithPlaceTimeAndAdvice) {
  SmallModel<> small(unit_cells<2>(16), {{1, 1}, {9, 9}, {2, 2}});
  arrange(small.model);
  small.particles().position(0)[small.row(2)] = -0.5;
  const auto [text, particle] = error_of([&] { stop_outside(small.model, at_step_12(), 32); });
  EXPECT_EQ(particle, 2);
  expect_in("a particle has left the domain: at t = 0.5 s, step 12, dt = 0.001 s", text);
  expect_in("particle 2 of body `body`", text);
  expect_in("-0.5, 2 m", text);
  expect_in("outflow", text);
}

TEST(Faults, AStateThatIsNotFiniteIsNamed) {
  SmallModel<> small(unit_cells<2>(16), {{1, 1}, {9, 9}});
  arrange(small.model);
  small.particles().state(3)[small.row(1)] = std::nan("");
  const auto [text, particle] = error_of([&] { stop_at_bad_stress(small.model, at_step_12(), 32); });
  EXPECT_EQ(particle, 1);
  expect_in("the stress is not finite", text);
}

TEST(Faults, APositionThatIsNotFiniteIsNoParticleOutsideAndTheCauseIsNamedIfTheMaterialIsTooSoft) {
  // g h/c^2, h = 1 m: with g = 10 m/s2 and waves at 5 m/s the weight of a cell strains it by 40 %, at 500 m/s by 0.004 %.
  SmallModel<> small(unit_cells<2>(16), {{1, 1}, {9, 9}});
  arrange(small.model);
  small.model.gravity = {0, -10};
  small.particles().position(1)[small.row(1)] = std::nan("");
  const auto [text, particle] = error_of([&] { stop_outside(small.model, at_step_12(), 5); });
  EXPECT_EQ(particle, 1);
  expect_in("the state is not finite: at t = 0.5 s, step 12", text);
  expect_in("Wave speed 5 m/s, gravity 10 m/s2: the weight of one cell (1 m) strains it by 40 %", text);
  expect_in("Use a stiffer material or less gravity.", text);
  EXPECT_EQ(text.find("larger domain"), std::string::npos) << text;
  const std::string stiff = error_of([&] { stop_outside(small.model, at_step_12(), 500); }).first;
  expect_in("use a smaller `cfl`", stiff);
  EXPECT_EQ(stiff.find("stiffer"), std::string::npos) << stiff;
}

TEST(Faults, OfAStepThatCollapsesTheFastestParticleOrWaveIsNamed) {
  // Waves at sqrt(1000/1) = 32 m/s in all; one particle at 100 m/s.
  SmallModel<> small(unit_cells<2>(16), {{1, 1}, {9, 9}, {2, 2}});
  arrange(small.model);
  small.particles().velocity(1)[small.row(1)] = -100;
  const auto [text, particle] = error_of([&] { stop_at_short_step(small.model, at_step_12(), 1e-12, 32, 0); });
  EXPECT_EQ(particle, 1);
  expect_in("the time step has collapsed to 1e-12 s at t = 0.5 s, step 12", text);
}

}  // namespace talus::faults_test
