#include "talus/law/granular.hpp"

#include <gtest/gtest.h>

#include "law/parameter_sets.hpp"

namespace talus::granular_test {

using T = SymTensor<double>;

TEST(Granular, IsTheSumOfItsParts) {
  const Granular law = case_1();
  auto s = isotropic_state(law, 400, 0.85);
  auto contacts = isotropic_state(law.frictional, 400, 0.85);
  const Motion<double> motion{{-1e-5, 0, 0, 2e-5, 0, 1e-5}, {-1, 0, 0, 2, 0, 1}, 1e-5};
  law.update(s, motion, implicit);
  law.frictional.update(contacts, motion, implicit);
  const auto collisions =
      law.collisional.collide(motion.strain_rate, law.frictional.void_ratio(contacts), pressure(contacts.stress));
  const T total = Granular::total_stress(s);
  for (int k = 0; k < 6; ++k) EXPECT_EQ(total[k], contacts.stress[k] + collisions.stress[k]);
}

TEST(Granular, SeparatedGrainsDoNotCollide) {
  const Granular law = case_1();
  auto s = isotropic_state(law, 400, 0.85);
  const auto r = law.update(s, Motion<double>{T::isotropic(0.01), {0, 0, 0, 100, 0, 0}, 1e-4}, implicit);
  EXPECT_EQ(Outcome(r.outcome), Outcome::separated);
  EXPECT_EQ(von_mises(Granular::total_stress(s)), 0);
  EXPECT_EQ(r.viscosity, 0);
}

TEST(Granular, GrainsWithoutPressureThatStillTouchCollide) {
  const Granular law = case_1();
  auto s = isotropic_state(law, 0, 0.95);  // loose: shear takes what pressure there might be
  const auto r = law.update(s, Motion<double>{{0, 0, 0, 1e-3, 0, 0}, {0, 0, 0, 100, 0, 0}, 1e-5}, implicit);
  EXPECT_EQ(Outcome(r.outcome), Outcome::zero_pressure);
  const double f = law.collisional.momentum_exchange(1 / 1.95);
  EXPECT_NEAR(Granular::total_stress(s).yy, -f * 1e4, 1e-9);
}

TEST(Granular, BothVariantsCarryTheSameContacts) {
  const Granular total = case_1();
  GranularWithHistory rate{total.frictional, total.collisional};
  rate.collisional.form = CollisionalForm::rate;
  auto a = isotropic_state(total, 400, 0.85);
  auto b = isotropic_state(rate, 400, 0.85);
  for (int i = 0; i < 20; ++i) {
    const Motion<double> motion{{0, 0, 0, 1e-6, 0, 0}, {0, 0, 0, 1, 0, 0}, 1e-6};
    total.update(a, motion, implicit);
    rate.update(b, motion, implicit);
  }
  for (int k = 0; k < 6; ++k) EXPECT_EQ(a.frictional.stress[k], b.frictional.stress[k]);
}

}  // namespace talus::granular_test
