/// What the laws of cohesion and friction share: the apex, what opens beyond it, and the ledger of energy.

#include "talus/law/cohesive_friction.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "law/parameter_sets.hpp"
#include "talus/law/drucker_prager.hpp"
#include "talus/law/mohr_coulomb.hpp"

namespace talus::cohesive_friction_test {

using T = SymTensor<double>;
using State = CohesiveFriction::State<double>;
constexpr double degree = std::numbers::pi / 180;

DruckerPrager cone(double c, double phi, double psi) {
  DruckerPrager m{1e7, 0.3, c, phi * degree, psi * degree, 0, ConeMatch::compression, 0, 0};
  m.prepare();
  return m;
}
MohrCoulomb soil(double c, double phi, double psi, LodeRule lode = LodeRule::mohr_coulomb) {
  MohrCoulomb m{1e7, 0.3, c, phi * degree, psi * degree, 0, lode, 0, 0};
  m.prepare();
  return m;
}

// ---- energy ------------------------------------------------------------------------------------------------------

/// Opening under constant tension c cot phi takes its work from outside, and closing gives it back.
template <class Law>
void expect_tension_to_be_in_the_ledger(const Law& law) {
  const double tension = 5e3 / std::tan(30 * degree);
  State s = isotropic_state(law, 1e3, 0);
  const auto lost_to_volume = [&](double expansion) { return std::expm1(-expansion) * law.elastic_energy(s); };
  // From p = 1 kPa to the apex is elastic, (1 kPa + tension)/K; the rest of 0.01 opens.
  const double opening = 0.01 - (1e3 + tension) / law.bulk_modulus();
  double lost = lost_to_volume(0.01);
  const auto opened = law.update(s, strain_by(T::isotropic(0.01 / 3)), implicit);
  EXPECT_EQ(Outcome(opened.outcome), Outcome::separated);
  EXPECT_NEAR(opened.plastic_work - lost, tension * opening, 1e-9 * tension);
  EXPECT_NEAR(law.elastic_energy(s), tension * tension / (2 * law.bulk_modulus()), 1e-9);
  lost += lost_to_volume(-0.5 * opening);
  const auto half = law.update(s, strain_by(T::isotropic(-0.5 * opening / 3)), implicit);
  EXPECT_NEAR(half.plastic_work - lost_to_volume(-0.5 * opening), -0.5 * tension * opening, 1e-9 * tension);
  lost += lost_to_volume(0.5 * opening - 0.01);
  const auto closed = law.update(s, strain_by(T::isotropic((0.5 * opening - 0.01) / 3)), implicit);
  EXPECT_NEAR(opened.plastic_work + half.plastic_work + closed.plastic_work, lost, 1e-9 * tension);
}

TEST(CohesiveFriction, OpeningAgainstTensionIsPlasticWorkAndClosingGivesItBack) {
  expect_tension_to_be_in_the_ledger(cone(5e3, 30, 10));
  for (LodeRule lode : {LodeRule::mohr_coulomb, LodeRule::sheng, LodeRule::none})
    expect_tension_to_be_in_the_ledger(soil(5e3, 30, 10, lode));
}

/// Work of the stress [J/m3] on the way through shear, expansion beyond the apex and closing, and the part of it that
/// is neither stored nor told as plastic work.
/// On a way of n steps: what the trapezoidal rule has for the work, and what is neither stored nor plastic work.
struct Balance {
  double work = 0, missing = 0;
};
template <class Law>
Balance balance(const Law& law, int n) {
  State s = isotropic_state(law, 2e4, 0);
  Balance b;
  for (const T& way : {T{0, 0, 0, 0.01, 0, 0}, T{0.01, 0.005, 0.005, 0.01, 0, 0}, T{-0.01, -0.005, -0.01, 0, 0.01, 0}})
    for (int i = 0; i < n; ++i) {
      const T strain = (1.0 / n) * way, before = s.stress;
      const double left = std::exp(-trace(strain)) * law.elastic_energy(s);  // in a unit of volume after the step
      const auto r = law.update(s, strain_by(strain), implicit);
      const double work = 0.5 * double_dot(before + s.stress, strain);
      b.work += std::abs(work);
      b.missing += work - r.plastic_work - (law.elastic_energy(s) - left);
      EXPECT_NEAR(r.work - r.plastic_work, law.elastic_energy(s) - left, 1e-9 * (left + std::abs(work)));
    }
  return b;
}
template <class Law>
void expect_work_to_be_stored_or_plastic(const Law& law) {
  const Balance coarse = balance(law, 500), fine = balance(law, 4000);
  EXPECT_LT(std::abs(coarse.missing), 0.01 * coarse.work);
  EXPECT_LT(std::abs(fine.missing), 0.00125 * fine.work);  // first order in the step
}

TEST(CohesiveFriction, WorkOfTheStressIsStoredOrPlasticWork) {
  for (double c : {0.0, 5e3})
    for (double psi : {0.0, 10.0}) {
      expect_work_to_be_stored_or_plastic(cone(c, 30, psi));
      for (LodeRule lode : {LodeRule::mohr_coulomb, LodeRule::none})
        expect_work_to_be_stored_or_plastic(soil(c, 30, psi, lode));
    }
}

// ---- the laws beside each other ----------------------------------------------------------------------------------

TEST(CohesiveFriction, InTriaxialCompressionConeAndPyramidAreOne) {
  // Shear to failure, opening beyond the apex, closing: lateral strains grow more than the axial one all the way, so
  // the stress stays in triaxial compression, where the hexagon too has the slope of the cone.
  const T ways[] = {{-1e-3, 5e-4, 5e-4, 0, 0, 0}, {1e-4, 3e-4, 3e-4, 0, 0, 0}, {-5e-4, -3e-4, -3e-4, 0, 0, 0}};
  for (LodeRule lode : {LodeRule::none, LodeRule::mohr_coulomb}) {
    const DruckerPrager a = cone(5e3, 30, 10);
    const MohrCoulomb b = soil(5e3, 30, 10, lode);
    State in_a = isotropic_state(a, 2e4, 0), in_b = isotropic_state(b, 2e4, 0);
    int visited[5] = {};
    for (const T& way : ways)
      for (int i = 0; i < 100; ++i) {
        const auto from_a = a.update(in_a, strain_by(way), implicit);
        const auto from_b = b.update(in_b, strain_by(way), implicit);
        ++visited[int(from_a.outcome)];
        ASSERT_EQ(from_a.outcome, from_b.outcome) << i;
        // roundings only: stresses are some 1e5 Pa, their work some 1e2 J/m3 a step
        for (int k = 0; k < 6; ++k) ASSERT_NEAR(in_a.stress[k], in_b.stress[k], 1e-4) << i;
        ASSERT_NEAR(in_a.compression, in_b.compression, 1e-11);
        ASSERT_NEAR(in_a.kappa, in_b.kappa, 1e-11);
        ASSERT_NEAR(from_a.plastic_work, from_b.plastic_work, 1e-6);
      }
    EXPECT_GT(visited[int(Outcome::plastic)], 50);
    EXPECT_GT(visited[int(Outcome::separated)], 20);
  }
}

TEST(CohesiveFriction, AtTheApexOfThePyramidExpansionOpensOnlyBeyondWhatShearDilates) {
  // Where nothing is carried, all of the shear, g (1, 0, -1) in principal directions, flows: across the face of s1 and s3,
  // (1 + sin psi, 0, -1 + sin psi), and that of s2 and s3, (0, 1 + sin psi, -1 + sin psi), whose deviators add up to it if the
  // sum of both amounts is g/(1 - sin psi/3). Each dilates by 2 sin psi.
  const MohrCoulomb law = soil(0, 30, 10);
  const double g = 1e-3, sine = std::sin(10 * degree), dilates = 2 * sine * g / (1 - sine / 3);
  const auto sheared = [&](double expansion) {
    State s = isotropic_state(law, 0, 0);
    T strain = T::isotropic(expansion / 3);
    strain.xy = g;
    law.update(s, strain_by(strain), implicit);
    return s;
  };
  const State less = sheared(0.99 * dilates), more = sheared(1.01 * dilates);
  // On the edge where s1 = s2 = s3/N, N = tan^2(45 + phi/2) = 3, the deviator -2 p (N - 1)/(N + 2) along s3 takes its part
  // of the shear: p (1/K + 2 sin psi/(1 - sin psi/3) (N - 1)/((N + 2) G)) = dilates - expansion.
  const double p =
      0.01 * dilates / (1 / law.bulk_modulus() + 2 * sine / (1 - sine / 3) * 2 / (5 * law.shear_modulus()));
  const double M = 6 * 0.5 / (3 - 0.5);  // of triaxial compression
  EXPECT_NEAR(pressure(less.stress), p, 1e-9 * p);
  EXPECT_NEAR(von_mises(deviator(less.stress)), M * p, 1e-9 * p);
  EXPECT_EQ(pressure(more.stress), 0);
  EXPECT_NEAR(more.compression, -1.01 * dilates, 1e-18);
}

TEST(CohesiveFriction, MeanTensionBeyondCohesionTimesCotangentIsNoStateOfRest) {
  // c cot phi = 5e3 sqrt 3 = 8660 Pa
  const MohrCoulomb law = soil(5e3, 30, 0);
  EXPECT_TRUE(std::holds_alternative<std::string>(law.at_rest({T::isotropic(8.7e3), 0, {}})));
  EXPECT_TRUE(std::holds_alternative<State>(law.at_rest({T::isotropic(8.6e3), 0, {}})));
}

// ---- any step from any state -------------------------------------------------------------------------------------

TEST(CohesiveFriction, APackOnThePyramidGivesTheBitsOfSinglePoints) {
  std::mt19937_64 generator(1);
  const auto uniform = [&](double a, double b) { return a + (b - a) * double(generator() >> 11) * 0x1p-53; };
  int visited[5] = {};
  for (double c : {0.0, 5e3})
    for (LodeRule lode : {LodeRule::mohr_coulomb, LodeRule::sheng, LodeRule::none}) {
      const MohrCoulomb law = soil(c, 35, 10, lode);
      State one[pack_width];
      MohrCoulomb::State<Pack> all;
      for (int lane = 0; lane < pack_width; ++lane)
        set_lane(all, lane, one[lane] = isotropic_state(law, 1e2 * lane * lane, 0));
      for (int i = 0; i < 500; ++i) {
        Motion<Pack> motion;
        motion.dt = 1;
        motion.strain_rate = SymTensor<Pack>::zero();
        T strains[pack_width];
        for (int lane = 0; lane < pack_width; ++lane) {
          const double size = std::pow(10.0, uniform(-6, -1));
          for (int k = 0; k < 6; ++k) strains[lane][k] = size * uniform(-1, 1);
          set_lane(motion.strain, lane, strains[lane]);
        }
        const Response<Pack> together = law.update(all, motion, implicit);
        for (int lane = 0; lane < pack_width; ++lane) {
          const Response<double> alone = law.update(one[lane], strain_by(strains[lane]), implicit);
          const State s = lane_of<State>(all, lane);
          ++visited[int(alone.outcome)];
          for (int k = 0; k < 6; ++k) ASSERT_EQ(s.stress[k], one[lane].stress[k]) << i;
          ASSERT_EQ(s.compression, one[lane].compression);
          ASSERT_EQ(s.kappa, one[lane].kappa);
          ASSERT_EQ(together.outcome[lane], alone.outcome);
          ASSERT_EQ(together.plastic_work[lane], alone.plastic_work);
        }
      }
    }
  for (Outcome o : {Outcome::elastic, Outcome::plastic, Outcome::separated}) EXPECT_GT(visited[int(o)], 500);
}

}  // namespace talus::cohesive_friction_test
