/// What `stiffness_factor` does to a law, whichever it is.

#include <gtest/gtest.h>

#include "law/parameter_sets.hpp"
#include "talus/law/registry.hpp"

namespace talus::stiffness_test {

/// A law of each kind that has an elastic stiffness, prepared.
std::vector<AnyLaw> elastic_laws() {
  MohrCoulomb pyramid{};
  DruckerPrager cone{};
  for (CohesiveFriction* law : {static_cast<CohesiveFriction*>(&pyramid), static_cast<CohesiveFriction*>(&cone)}) {
    law->E = 1e7;
    law->nu = 0.3;
    law->c = 1e3;
    law->phi = 0.5;
    law->psi = 0.1;
  }
  pyramid.prepare();
  cone.prepare();
  GranularWithHistory history{case_1_sand(), case_1_grains()};
  history.collisional.form = CollisionalForm::rate;
  return {LinearElastic{{1e7, 0.3}}, pyramid, cone, case_1_sand(), case_1(), history};
}

TEST(Stiffness, ScaledItScalesTheWaveModulusAndTheEnergyOfAGivenStressInversely) {
  const double factor = 0.1;
  InitialState initial;
  initial.stress = {-6e3, -10e3, -6e3, 1e3, 0, 0};
  initial.void_ratio = 0.8;
  for (const AnyLaw& any_law : elastic_laws()) {
    const AnyLaw any_softer = with_scaled_stiffness(any_law, factor);
    std::visit(
        [&]<class Law>(const Law& law) {
          SCOPED_TRACE(law.name);
          using State = typename Law::template State<double>;
          const Law& softer = std::get<Law>(any_softer);
          State stiff = std::get<State>(law.at_rest(initial)), soft = std::get<State>(softer.at_rest(initial));
          for (int c = 0; c < 6; ++c) EXPECT_EQ(Law::total_stress(soft)[c], Law::total_stress(stiff)[c]);
          EXPECT_EQ(softer.specific_volume(soft), law.specific_volume(stiff));
          EXPECT_EQ(softer.earth_pressure_at_rest(), law.earth_pressure_at_rest());
          const double energy = law.elastic_energy(stiff);
          EXPECT_GT(energy, 0);
          EXPECT_NEAR(softer.elastic_energy(soft), energy / factor, 1e-12 * energy / factor);
          const Motion<double> nothing = strain_by(SymTensor<double>::zero());
          const double modulus = law.update(stiff, nothing, implicit).stiffness;
          EXPECT_NEAR(softer.update(soft, nothing, implicit).stiffness, factor * modulus, 1e-12 * modulus);
        },
        any_law);
  }
}

TEST(Stiffness, AtTheStartTheElasticCompressionIsThatOfTheScaledStiffness) {
  for (const AnyLaw& any_law : elastic_laws())
    std::visit(
        [&]<class Law>(const Law& law) {
          SCOPED_TRACE(law.name);
          if constexpr (AveragesPressure<Law>) {
            const auto state = isotropic_state(law, 10e3, 0.8);
            EXPECT_NEAR(contacts(law).pressure_at(contacts(law).compression(contacts(state))), 10e3, 1e-8);
          }
        },
        with_scaled_stiffness(any_law, 0.1));
}

TEST(Stiffness, CollisionsAloneHaveNone) {
  EXPECT_FALSE(ScalesStiffness<MuI>);
  EXPECT_TRUE(ScalesStiffness<Granular>);
}

}  // namespace talus::stiffness_test
