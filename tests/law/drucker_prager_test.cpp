#include "talus/law/drucker_prager.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "law/parameter_sets.hpp"

namespace talus::drucker_prager_test {

using T = SymTensor<double>;
using State = DruckerPrager::State<double>;
constexpr double degree = std::numbers::pi / 180;

DruckerPrager cone(double c, double phi, double psi, ConeMatch match = ConeMatch::compression) {
  DruckerPrager m{1e7, 0.3, c, phi * degree, psi * degree, 0, match, 0, 0};
  m.prepare();
  return m;
}
constexpr ConeMatch matches[] = {ConeMatch::compression, ConeMatch::plane_strain, ConeMatch::extension};

/// f over the distance of the pressure to the apex: 0 on the cone, negative inside.
double f_over_p(const DruckerPrager& law, const State& s) {
  const double p = pressure(s.stress) - law.apex;
  return (von_mises(deviator(s.stress)) - law.M * p) / p;
}

/// Strains along x by the increment e while the stress along y is held, and along z too or, in plane strain, no strain.
/// Returns the strain increment of the last step.
T strain_drained(const DruckerPrager& law, State& s, double e, int n_steps, bool plane_strain) {
  const double held = s.stress.yy;
  T last = T::zero();
  for (int i = 0; i < n_steps; ++i) {
    const auto strain = [&](double y) { return T{e, y, plane_strain ? 0 : y, 0, 0, 0}; };
    const auto miss = [&](double y) {
      State next = s;
      law.update(next, strain_by(strain(y)), implicit);
      return next.stress.yy - held;
    };
    // The stress grows with the strain. No flow here is wider than e_y/e_x = tan^2(45 + psi/2) = 3 at psi = 30 deg.
    double low = -4 * std::abs(e), high = 4 * std::abs(e);
    for (int k = 0; k < 60; ++k) (miss(0.5 * (low + high)) < 0 ? low : high) = 0.5 * (low + high);
    law.update(s, strain_by(last = strain(0.5 * (low + high))), implicit);
  }
  return last;
}

// ---- strength ----------------------------------------------------------------------------------------------------

TEST(DruckerPrager, SlopesAreThoseOfTheBook) {
  // sin 30 deg = 1/2
  EXPECT_NEAR(cone(0, 30, 30, ConeMatch::compression).M, 6 * 0.5 / 2.5, 1e-14);
  EXPECT_NEAR(cone(0, 30, 30, ConeMatch::extension).M, 6 * 0.5 / 3.5, 1e-14);
  // q = sqrt 3 sqrt J2, and the book's eta = 3 tan phi/sqrt(9 + 12 tan^2 phi), with tan^2 30 deg = 1/3
  EXPECT_NEAR(cone(0, 30, 30, ConeMatch::plane_strain).M, std::sqrt(3) * 3 / std::sqrt(3) / std::sqrt(9 + 4), 1e-14);
  // without dilatancy plane strain is simple shear, s_zz = 0: q = sqrt 3 tau, tau = p sin phi
  EXPECT_NEAR(cone(0, 30, 0, ConeMatch::plane_strain).M, std::sqrt(3) * 0.5, 1e-14);
  for (ConeMatch match : matches) {
    EXPECT_NEAR(cone(0, 30, 30, match).M_psi, cone(0, 30, 30, match).M, 1e-15);
    EXPECT_EQ(cone(0, 30, 0, match).M_psi, 0);
  }
}

TEST(DruckerPrager, FailsInTriaxialCompressionWhereMohrAndCoulombDo) {
  // sigma_1 = sigma_3 N + 2 c sqrt N with N = tan^2(45 + phi/2) = 3
  for (double psi : {0.0, 10.0, 30.0}) {
    const DruckerPrager law = cone(5e3, 30, psi);
    State s = isotropic_state(law, 1e5, 0);
    strain_drained(law, s, -2e-4, 300, false);
    EXPECT_NEAR(-s.stress.xx, 1e5 * 3 + 2 * 5e3 * std::sqrt(3), 1e-3) << psi;
  }
}

TEST(DruckerPrager, MatchedToExtensionFailsThereWhereMohrAndCoulombDo) {
  // Here the held stress is the larger one: sigma_3 = (sigma_1 - 2 c sqrt N)/N
  const DruckerPrager law = cone(5e3, 30, 10, ConeMatch::extension);
  State s = isotropic_state(law, 1e5, 0);
  strain_drained(law, s, 2e-4, 300, false);
  EXPECT_NEAR(-s.stress.xx, (1e5 - 2 * 5e3 * std::sqrt(3)) / 3, 1e-3);
}

TEST(DruckerPrager, MatchedToPlaneStrainFailsThereWhereMohrAndCoulombDo) {
  for (double psi : {0.0, 10.0, 30.0}) {
    const DruckerPrager law = cone(5e3, 30, psi, ConeMatch::plane_strain);
    State s = isotropic_state(law, 1e5, 0);
    strain_drained(law, s, -2e-4, 4000, true);
    EXPECT_NEAR(-s.stress.xx, 1e5 * 3 + 2 * 5e3 * std::sqrt(3), 1e-3) << psi;
  }
}

TEST(DruckerPrager, TheOtherConesMissTheStrengthInPlaneStrainAsTheirSlopesSay) {
  // Without dilatancy s_zz = 0 at failure, so with c = 0 tau/p = M/sqrt 3 = (sigma_1 - sigma_3)/(sigma_1 + sigma_3).
  for (ConeMatch match : matches) {
    const DruckerPrager law = cone(0, 30, 0, match);
    State s = isotropic_state(law, 1e5, 0);
    strain_drained(law, s, -2e-4, 4000, true);
    EXPECT_NEAR((s.stress.xx - s.stress.yy) / (s.stress.xx + s.stress.yy), law.M / std::sqrt(3), 1e-8);
  }
}

TEST(DruckerPrager, InsideTheConeIsLinearElasticity) {
  const DruckerPrager law = cone(1e9, 30, 10);  // a cohesion that nothing here overcomes
  State s = isotropic_state(law, 1e5, 0);
  const double K = 1e7 / (3 * 0.4), G = 1e7 / 2.6;  // E/(3 (1 - 2 nu)), E/(2 (1 + nu))
  double stored = law.elastic_energy(s);
  for (int i = 0; i < 10; ++i) {
    const auto r = law.update(s, strain_by({-1e-3, 2e-4, 5e-4, 3e-4, 0, -2e-4}), implicit);
    EXPECT_EQ(Outcome(r.outcome), Outcome::elastic);
    // What was stored is stored in less volume now: 3e-4 of it are not there any more. All work is stored.
    const double left = std::exp(3e-4) * stored;
    EXPECT_NEAR(r.plastic_work, left - stored, 1e-9 * stored);
    stored = law.elastic_energy(s);
    EXPECT_NEAR(r.work, stored - left + r.plastic_work, 1e-9 * stored);
    EXPECT_DOUBLE_EQ(r.stiffness, K + 4.0 / 3.0 * G);
  }
  // Strains are ten times the above, volumetric compression 3e-3.
  EXPECT_NEAR(pressure(s.stress), 1e5 + K * 3e-3, 1e-6);
  EXPECT_NEAR(s.stress.xx, -1e5 - K * 3e-3 + 2 * G * (-1e-2 + 1e-3), 1e-5);
  EXPECT_NEAR(s.stress.xy, 2 * G * 3e-3, 1e-6);
  EXPECT_EQ(s.kappa, 0);
}

TEST(DruckerPrager, AnyIsotropicCompressionStaysElastic) {
  const DruckerPrager law = cone(0, 30, 10);
  State s = isotropic_state(law, 0, 0);
  for (double e : {-1e-6, -1e-3, -0.1, 0.05, 0.04}) {
    const auto r = law.update(s, strain_by(T::isotropic(e)), implicit);
    EXPECT_EQ(Outcome(r.outcome), Outcome::elastic) << e;
  }
  EXPECT_NEAR(pressure(s.stress), law.bulk_modulus() * 3 * (0.101001 - 0.09), 1e-6);
  EXPECT_EQ(s.kappa, 0);
}

// ---- flow --------------------------------------------------------------------------------------------------------

TEST(DruckerPrager, DilatancyAngleOfTriaxialCompressionIsPsi) {
  // At failure the stress stays, so all strain is plastic: -d eps_v/d eps_1 = 2 sin psi/(1 - sin psi)
  const DruckerPrager law = cone(5e3, 35, 10);
  State s = isotropic_state(law, 1e5, 0);
  const T e = strain_drained(law, s, -2e-4, 400, false);
  EXPECT_NEAR(trace(e) / -e.xx, 2 * std::sin(10 * degree) / (1 - std::sin(10 * degree)), 1e-8);
}

TEST(DruckerPrager, DilatancyAngleOfTriaxialExtensionIsPsi) {
  // Two principal strains of compression and one of extension: d eps_v/d eps_3 = 2 sin psi/(1 + sin psi), tensile
  const DruckerPrager law = cone(5e3, 35, 10, ConeMatch::extension);
  State s = isotropic_state(law, 1e5, 0);
  const T e = strain_drained(law, s, 2e-4, 400, false);
  EXPECT_NEAR(trace(e) / e.xx, 2 * std::sin(10 * degree) / (1 + std::sin(10 * degree)), 1e-8);
}

TEST(DruckerPrager, DilatancyAngleOfPlaneStrainIsPsi) {
  // sin psi = d eps_v/d gamma with gamma = eps_3 - eps_1
  const DruckerPrager law = cone(5e3, 35, 10, ConeMatch::plane_strain);
  State s = isotropic_state(law, 1e5, 0);
  const T e = strain_drained(law, s, -2e-4, 4000, true);
  EXPECT_NEAR(trace(e) / (e.yy - e.xx), std::sin(10 * degree), 1e-8);
}

TEST(DruckerPrager, ShearAtConstantVolumePressesWhatWouldDilate) {
  // On the cone p grows by K M_psi d kappa, and q by M times that; what is left of 2 d eps_xy/sqrt 3 is plastic:
  // d kappa = 3 G (2/sqrt 3) d eps_xy/(3 G + K M M_psi)
  const DruckerPrager law = cone(2e3, 30, 10);
  State s = isotropic_state(law, 1e5, 0);
  for (int i = 0; i < 50; ++i) law.update(s, strain_by({0, 0, 0, 1e-3, 0, 0}), implicit);
  const State before = s;
  law.update(s, strain_by({0, 0, 0, 1e-3, 0, 0}), implicit);
  const double K = law.bulk_modulus(), G = law.shear_modulus();
  const double dkappa = 3 * G * 2e-3 / std::sqrt(3) / (3 * G + K * law.M * law.M_psi);
  EXPECT_NEAR(s.kappa - before.kappa, dkappa, 1e-14);
  EXPECT_NEAR(pressure(s.stress) - pressure(before.stress), K * law.M_psi * dkappa, 1e-6);
  EXPECT_NEAR(f_over_p(law, s), 0, 1e-13);
}

// ---- the apex ----------------------------------------------------------------------------------------------------

TEST(DruckerPrager, CarriesMeanTensionUpToCohesionTimesCotangent) {
  const DruckerPrager law = cone(5e3, 30, 10);
  State s = isotropic_state(law, 1e3, 0);
  const auto r = law.update(s, strain_by({0.01, 0.012, 0.009, 1e-4, 0, 0}), implicit);
  EXPECT_NEAR(pressure(s.stress), -5e3 * std::sqrt(3), 1e-9);
  EXPECT_NEAR(von_mises(deviator(s.stress)), 0, 1e-9);
  EXPECT_EQ(Outcome(r.outcome), Outcome::separated);
}

TEST(DruckerPrager, OpensAtTheApexAndClosesBeforeItPresses) {
  for (double c : {0.0, 5e3}) {
    const DruckerPrager law = cone(c, 30, 10);
    State s = isotropic_state(law, 1e3, 0);
    law.update(s, strain_by(T::isotropic(0.01 / 3)), implicit);
    EXPECT_NEAR(pressure(s.stress), law.apex, 1e-9);
    law.update(s, strain_by(T::isotropic(-0.0085 / 3)), implicit);
    EXPECT_NEAR(pressure(s.stress), law.apex, 1e-9);
    law.update(s, strain_by(T::isotropic(-0.0015 / 3)), implicit);
    EXPECT_NEAR(pressure(s.stress), 1e3, 1e-6);
  }
}

TEST(DruckerPrager, AtTheApexExpansionOpensOnlyBeyondWhatShearDilates) {
  // eps_d = 2/sqrt 3 eps_xy makes room for a dilatancy of M_psi eps_d.
  const DruckerPrager law = cone(0, 30, 10);
  const double dilates = law.M_psi * 2 / std::sqrt(3) * 1e-3;
  const auto sheared = [&](double expansion) {
    State s = isotropic_state(law, 0, 0);
    T strain = T::isotropic(expansion / 3);
    strain.xy = 1e-3;
    law.update(s, strain_by(strain), implicit);
    return s;
  };
  const State less = sheared(0.99 * dilates), more = sheared(1.01 * dilates);
  // On the cone p = K (M_psi d kappa - expansion) and q = 3 G (eps_d - d kappa) = M p; eliminating d kappa,
  // p (1/K + M M_psi/(3 G)) = dilates - expansion
  const double p = 0.01 * dilates / (1 / law.bulk_modulus() + law.M * law.M_psi / (3 * law.shear_modulus()));
  EXPECT_NEAR(pressure(less.stress), p, 1e-9 * p);
  EXPECT_NEAR(f_over_p(law, less), 0, 1e-10);
  EXPECT_EQ(pressure(more.stress), 0);
  EXPECT_NEAR(more.compression, -1.01 * dilates, 1e-18);
  EXPECT_NEAR(more.kappa, 2e-3 / std::sqrt(3), 1e-15);  // all deviatoric strain is plastic
}

TEST(DruckerPrager, ShearDoesNotCloseAnOpening) {
  const DruckerPrager law = cone(0, 30, 10);
  State s = isotropic_state(law, 0, 0);
  law.update(s, strain_by(T::isotropic(1e-5)), implicit);
  const auto r = law.update(s, strain_by({0, 0, 0, 0.1, 0, 0}), implicit);
  EXPECT_EQ(Outcome(r.outcome), Outcome::separated);
  EXPECT_EQ(pressure(s.stress), 0);
  EXPECT_NEAR(s.compression, -3e-5, 1e-18);
}

// ---- any step from any state -------------------------------------------------------------------------------------

/// Random strains of sizes from 1e-6 to 0.1, expansion and compression among them.
struct RandomWalk {
  std::mt19937_64 engine{20240607};
  double uniform(double a, double b) { return std::uniform_real_distribution<double>(a, b)(engine); }
  T strain() {
    T e;
    const double size = std::pow(10, uniform(-6, -1));
    for (int k = 0; k < 6; ++k) e[k] = size * uniform(-1, 1);
    return e;
  }
};

TEST(DruckerPrager, RandomStepsNeverLeaveTheConeOrCreateEnergyOrNumbers) {
  RandomWalk walk;
  int visited[5] = {};
  for (ConeMatch match : matches)
    for (double c : {0.0, 5e3}) {
      const DruckerPrager law = cone(c, 35, 10, match);
      State s = isotropic_state(law, 1e4, 0);
      for (int i = 0; i < 3000; ++i) {
        const State before = s;
        const T strain = walk.strain();
        const auto r = law.update(s, strain_by(strain), implicit);
        ++visited[int(r.outcome)];
        for (int k = 0; k < 6; ++k) ASSERT_TRUE(std::isfinite(s.stress[k]));
        ASSERT_TRUE(std::isfinite(s.compression) && s.kappa >= before.kappa && s.volume_ratio > 0);
        const double p = pressure(s.stress) - law.apex, q = von_mises(deviator(s.stress));
        ASSERT_GE(p, -1e-9);
        ASSERT_LE(q, law.M * p + 1e-9 * (q + 1e4));
        // Flow takes work, it gives none; and what the strain takes is either stored or that.
        if (s.compression > law.closed()) {
          ASSERT_GE((q - (p + law.apex) * law.M_psi) * (s.kappa - before.kappa), -1e-9 * q);
        }
        if (std::min(s.compression, before.compression) < law.closed()) continue;
        const double work = 0.5 * double_dot(before.stress + s.stress, strain);
        const double left = std::exp(-trace(strain)) * law.elastic_energy(before);
        const double scale = 1e-9 * (std::abs(work) + left + law.elastic_energy(s));
        ASSERT_NEAR(r.work, work, scale);
        ASSERT_NEAR(r.plastic_work, work - law.elastic_energy(s) + left, scale);
      }
    }
  for (Outcome o : {Outcome::elastic, Outcome::plastic, Outcome::separated}) EXPECT_GT(visited[int(o)], 500);
  EXPECT_EQ(visited[int(Outcome::unconverged)], 0);
}

TEST(DruckerPrager, APackGivesTheBitsOfSinglePoints) {
  RandomWalk walk;
  for (double c : {0.0, 5e3}) {
    const DruckerPrager law = cone(c, 35, 10, ConeMatch::plane_strain);
    State one[pack_width];
    DruckerPrager::State<Pack> many;
    for (int lane = 0; lane < pack_width; ++lane) {
      const double pressures[] = {400, 0, 1e5, 1, 30};
      one[lane] = isotropic_state(law, pressures[lane % 5], 0);
      set_lane(many, lane, one[lane]);
    }
    for (int i = 0; i < 2000; ++i) {
      Motion<Pack> motion;
      motion.dt = 1;
      motion.strain_rate = SymTensor<Pack>::zero();
      T strains[pack_width];
      for (int lane = 0; lane < pack_width; ++lane) set_lane(motion.strain, lane, strains[lane] = walk.strain());
      const Response<Pack> all = law.update(many, motion, implicit);
      const Pack energy = law.elastic_energy(many);
      for (int lane = 0; lane < pack_width; ++lane) {
        const Response<double> r1 = law.update(one[lane], strain_by(strains[lane]), implicit);
        const State s = lane_of<State>(many, lane);
        for (int k = 0; k < 6; ++k) ASSERT_EQ(s.stress[k], one[lane].stress[k]) << i;
        ASSERT_EQ(s.compression, one[lane].compression);
        ASSERT_EQ(s.kappa, one[lane].kappa);
        ASSERT_EQ(s.volume_ratio, one[lane].volume_ratio);
        ASSERT_EQ(energy[lane], law.elastic_energy(one[lane]));
        ASSERT_EQ(all.outcome[lane], r1.outcome);
        ASSERT_EQ(all.plastic_work[lane], r1.plastic_work);
      }
    }
  }
}

TEST(DruckerPrager, TurnedMaterialAnswersWithTurnedStress) {
  const DruckerPrager law = cone(2e3, 30, 10);
  const Tensor<double> Q = incremental_rotation(Tensor<double>{{{0, -2, 0.5}, {2, 0, -1}, {-0.5, 1, 0}}}, 0.7);
  const T strain{-4e-4, 3e-4, 1e-4, 4e-4, -3e-4, 1e-4};
  State a = std::get<State>(law.at_rest({{-1.2e5, -1.0e5, -0.9e5, 1e4, 2e3, -3e3}, 0, {}})), b = a;
  DruckerPrager::turn(b, Q);
  for (int i = 0; i < 40; ++i) {
    law.update(a, strain_by(strain), implicit);
    law.update(b, strain_by(rotate(Q, strain)), implicit);
  }
  DruckerPrager::turn(a, Q);
  EXPECT_GT(a.kappa, 0.01);
  for (int k = 0; k < 6; ++k) EXPECT_NEAR(b.stress[k], a.stress[k], 1e-8 * 1e5);
  EXPECT_NEAR(a.kappa, b.kappa, 1e-15);
}

TEST(DruckerPrager, AveragedCompressionKeepsTheStressOnTheCone) {
  const DruckerPrager law = cone(2e3, 30, 10);
  State s = isotropic_state(law, 1e5, 0);
  for (int i = 0; i < 50; ++i) law.update(s, strain_by({0, 0, 0, 1e-3, 0, 0}), implicit);
  const double w = 0.3 * DruckerPrager::compression(s);
  law.impose_compression(s, w, law.pressure_at(w));
  EXPECT_NEAR(pressure(s.stress), law.bulk_modulus() * w, 1e-9);
  EXPECT_NEAR(f_over_p(law, s), 0, 1e-12);
  law.impose_compression(s, -1.0, law.pressure_at(-1.0));
  EXPECT_NEAR(pressure(s.stress), law.apex, 1e-9);
  EXPECT_NEAR(von_mises(deviator(s.stress)), 0, 1e-9);
}

TEST(DruckerPrager, AveragedCompressionTakesTheRoomOfTheOpeningsAlong) {
  // Two particles of a cell, one opened by 0.3, one closed, both of unit volume when closed: each gets half of the room.
  const DruckerPrager law = cone(0, 30, 0);
  State closed = isotropic_state(law, 0, 0), open = closed;
  law.update(open, strain_by({0.1, 0.1, 0.1, 0, 0, 0}), implicit);
  const double room = closed.volume_ratio + open.volume_ratio;
  EXPECT_NEAR(open.volume_ratio, std::exp(0.3), 1e-12);
  const double mean = std::log((closed.volume_ratio * 1 + open.volume_ratio * std::exp(open.compression)) / room);
  for (State* s : {&closed, &open}) law.impose_compression(*s, mean, law.pressure_at(mean));
  EXPECT_NEAR(closed.volume_ratio, room / 2, 1e-12);
  EXPECT_NEAR(open.volume_ratio, room / 2, 1e-12);
  for (State* s : {&closed, &open}) {
    const double shrinks = std::log(s->volume_ratio) / 3;  // and closes on the volume that it had at the start
    law.update(*s, strain_by({-shrinks, -shrinks, -shrinks, 0, 0, 0}), implicit);
    EXPECT_NEAR(s->volume_ratio, 1, 1e-12);
    EXPECT_NEAR(s->compression, 0, 1e-12);
  }
}

// ---- the start ---------------------------------------------------------------------------------------------------

TEST(DruckerPrager, RefusesAnInitialStressBeyondItsStrength) {
  const auto refused = [](const DruckerPrager& law, const T& stress) {
    return std::holds_alternative<std::string>(law.at_rest({stress, 0, {}}));
  };
  // q = 3e5 over p = 2e5 exceeds 1.2, the slope for 30 degrees; q = 1e5 over p = 4e5/3 does not
  EXPECT_TRUE(refused(cone(0, 30, 0), {-1e5, -4e5, -1e5, 0, 0, 0}));
  EXPECT_FALSE(refused(cone(0, 30, 0), {-1e5, -2e5, -1e5, 0, 0, 0}));
  // mean tension up to c cot phi = 5e3 sqrt 3 = 8660 Pa
  EXPECT_TRUE(refused(cone(5e3, 30, 0), T::isotropic(8.7e3)));
  EXPECT_FALSE(refused(cone(5e3, 30, 0), T::isotropic(8.6e3)));
  EXPECT_TRUE(refused(cone(0, 30, 0), T::isotropic(1)));
}

TEST(DruckerPrager, GroundAtRestIsWithinItsStrength) {
  for (ConeMatch match : matches)
    for (double phi : {5.0, 30.0, 45.0, 60.0}) {
      const DruckerPrager law = cone(0, phi, 0, match);
      const double k = law.earth_pressure_at_rest();
      EXPECT_GE(k, 1 - std::sin(phi * degree));
      const auto at_rest = law.at_rest({{-1e5 * k, -1e5, -1e5 * k, 0, 0, 0}, 0, {}});
      EXPECT_TRUE(std::holds_alternative<State>(at_rest)) << phi << " deg, match " << int(match);
    }
}

}  // namespace talus::drucker_prager_test
