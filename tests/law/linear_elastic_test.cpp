#include "talus/law/linear_elastic.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "law/parameter_sets.hpp"

namespace talus::linear_elastic_test {

using T = SymTensor<double>;
using State = LinearElastic::State<double>;

constexpr LinearElastic cauchy{1e6, 0.2}, kirchhoff{{1e6, 0.2}, StressMeasure::kirchhoff};

/// Strains a state n times by a part of `way`; the work of the stress on the volume, and what the law says of it that is not
/// stored [J per m3 at the start].
double strain(const LinearElastic& law, State& s, const T& way, int n, double* not_stored = nullptr) {
  double work = 0;
  for (int i = 0; i < n; ++i) {
    const T before = law.specific_volume(s) * LinearElastic::total_stress(s), part = (1.0 / n) * way;
    const auto response = law.update(s, strain_by(part), implicit);
    if (not_stored) *not_stored += law.specific_volume(s) * response.plastic_work;
    work += 0.5 * double_dot(before + law.specific_volume(s) * LinearElastic::total_stress(s), part);
  }
  return work;
}

TEST(LinearElastic, SmallStrainsGiveTheStressOfHookesLawInEitherMeasure) {
  for (const LinearElastic& law : {cauchy, kirchhoff}) {
    State s{T::zero(), 1};
    strain(law, s, {-1e-7, 0, 0, 0, 0, 0}, 1);
    EXPECT_NEAR(s.stress.xx, -1e6 * 0.8 / (1.2 * 0.6) * 1e-7, 1e-6 * 0.1);  // E (1-nu)/((1+nu)(1-2nu))
    EXPECT_NEAR(s.stress.yy, 0.25 * s.stress.xx, 1e-9);                     // nu/(1-nu)
  }
}

TEST(LinearElastic, ByKirchhoffsStressAStretchToTwiceTheLengthIsHenckys) {
  State s{T::zero(), 1};
  const double lambda = 2, M = 1e6 * 0.8 / (1.2 * 0.6);
  const double work = strain(kirchhoff, s, {std::log(lambda), 0, 0, 0, 0, 0}, 100);
  // no strain across: J = lambda, tau_xx = M ln lambda
  EXPECT_NEAR(s.volume_ratio, lambda, 1e-12);
  EXPECT_NEAR(s.stress.xx, M * std::log(lambda) / lambda, 1e-9 * M);
  EXPECT_NEAR(work, 0.5 * M * std::log(lambda) * std::log(lambda), 1e-9 * M);
  EXPECT_NEAR(s.volume_ratio * kirchhoff.elastic_energy(s), work, 1e-9 * M);
}

TEST(LinearElastic, OnlyKirchhoffsStressStoresAllTheWorkOfALargeStrain) {
  // To a stretch by a half, sheared there and back at once, back: what remains stored is nothing.
  for (const bool stores : {false, true}) {
    const LinearElastic& law = stores ? kirchhoff : cauchy;
    State s{T::zero(), 1};
    double not_stored = 0;
    const double there = strain(law, s, {std::log(1.5), 0, 0, 0.1, 0, 0}, 2000, &not_stored);
    const double stored = s.volume_ratio * law.elastic_energy(s);
    if (stores)
      EXPECT_NEAR(stored, there, 1e-9 * there);
    else
      EXPECT_GT(stored - there, 0.05 * there);  // d(J psi) = dwork + J psi tr d: of the order of ln J/3
    EXPECT_NEAR(stored + not_stored, there, 1e-9 * there);
    const double back = strain(law, s, {-std::log(1.5), 0, 0, -0.1, 0, 0}, 2000);
    EXPECT_NEAR(there + back, 0, (stores ? 1e-9 : 1e-2) * there);
  }
}

}  // namespace talus::linear_elastic_test
