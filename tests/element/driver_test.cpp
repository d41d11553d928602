#include "talus/element/driver.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "law/parameter_sets.hpp"
#include "talus/base/error.hpp"
#include "talus/input/read.hpp"

namespace talus::driver_test {

/// A test from text: linear elasticity unless the text says otherwise.
ElementResult run(const std::string& rest,
                  const std::string& material = "law = \"linear_elastic\"\nE = \"10 MPa\"\nnu = 0.25\n",
                  const std::string& initial = "pressure = \"100 kPa\"\n") {
  const std::string text = "title = \"test\"\n[material]\n" + material + "[initial]\n" + initial + rest;
  return run_element_test(read_element_test_text("test.toml", text, ".").test);
}

const std::string sand =
    "law = \"simsand\"\nE0 = 150\nnu = 0.2\nn = 0.6\nphi_c = \"23 deg\"\ne_ref = 0.907\nLambda = 0.022\nxi = 0.71\nA_d "
    "= 0.5\nk_p = 0.001\nn_p = 1\nn_d = 1\n";
const std::string sand_state = "pressure = \"100 kPa\"\nvoid_ratio = 0.80\n";

double last(const ElementResult& r, const std::string& name) { return r.rows.back().at(r.column(name)); }

TEST(Driver, OedometerOfAnElasticMaterialHasTheConstrainedModulus) {
  const auto r = run("[[segment]]\ntest = \"oedometer\"\naxial_strain = 0.001\nrows = 2\n");
  EXPECT_NEAR(last(r, "stress_yy") - 1e5, 1e7 * 0.75 / (1.25 * 0.5) * 0.001, 1e-6);  // M = E (1-nu)/((1+nu)(1-2nu))
  EXPECT_NEAR(last(r, "strain_xx"), 0, 1e-15);
  EXPECT_EQ(r.rows.size(), 3u);
}

TEST(Driver, ATestEndsWhereItWouldNeedMoreUpdatesThanItMay) {
  const ElementTest test =
      read_element_test_text("test.toml",
                             "title = \"test\"\n[material]\n" + sand + "[initial]\n" + sand_state +
                                 "[[segment]]\ntest = \"triaxial\"\ndrainage = \"drained\"\naxial_strain = 0.2\n",
                             ".")
          .test;
  const ElementResult whole = run_element_test(test), part = run_element_test(test, whole.n_updates / 2);
  EXPECT_TRUE(whole.failure.empty());
  EXPECT_NE(part.failure.find("updates of the law are needed"), std::string::npos) << part.failure;
  EXPECT_GT(part.n_updates, whole.n_updates / 2);
  EXPECT_LT(part.n_updates, whole.n_updates / 2 + 1000);  // a step of the driver is finished
  ASSERT_LT(part.rows.size(), whole.rows.size());
  for (std::size_t i = 0; i < part.rows.size(); ++i) EXPECT_EQ(part.rows[i], whole.rows[i]);
}

TEST(Driver, DrainedTriaxialTestOfAnElasticMaterialHasYoungsModulus) {
  const auto r = run("[[segment]]\ntest = \"triaxial\"\ndrainage = \"drained\"\naxial_strain = 0.001\n");
  EXPECT_NEAR(last(r, "stress_xx") - 1e5, 1e7 * 0.001, 1e-3);
  EXPECT_NEAR(last(r, "stress_yy"), 1e5, 1e-3);
  EXPECT_NEAR(last(r, "strain_yy"), -0.25 * 0.001, 1e-9);
}

TEST(Driver, UndrainedTestsKeepTheVolume) {
  for (const char* axis : {"x", "y", "z"}) {
    const auto r =
        run(std::string("[[segment]]\ntest = \"triaxial\"\ndrainage = \"undrained\"\naxial_strain = 0.05\naxis = \"") +
                axis + "\"\n",
            sand, sand_state);
    EXPECT_NEAR(last(r, "strain_xx") + last(r, "strain_yy") + last(r, "strain_zz"), 0, 1e-14);
    EXPECT_NEAR(last(r, std::string("strain_") + axis + axis), 0.05, 1e-14);
    EXPECT_NEAR(last(r, "void_ratio"), 0.80, 1e-12);
  }
}

TEST(Driver, ConstantMeanStressIsHeldAllTheWay) {
  const auto r =
      run("[[segment]]\ntest = \"triaxial\"\ndrainage = \"constant_p\"\naxial_strain = 0.05\n", sand, sand_state);
  for (const auto& row : r.rows) {
    EXPECT_NEAR(row[r.column("p")], 1e5, 0.1);
    EXPECT_NEAR(row[r.column("strain_yy")], row[r.column("strain_zz")], 1e-12);
  }
  EXPECT_GT(last(r, "q"), 5e4);
}

TEST(Driver, NormalStressIsHeldInSimpleShear) {
  const auto r =
      run("[[segment]]\ntest = \"simple_shear\"\ndrainage = \"constant_normal_stress\"\nshear_strain = 0.05\n", sand,
          sand_state);
  for (const auto& row : r.rows) EXPECT_NEAR(row[r.column("stress_yy")], 1e5, 0.1);
  EXPECT_NEAR(last(r, "strain_xx"), 0, 1e-15);
  EXPECT_LT(last(r, "strain_yy"), 0);  // dense: it dilates
}

TEST(Driver, StressGoesStraightToItsTarget) {
  const auto r =
      run("[[segment]]\ntest = \"isotropic_compression\"\npressure = \"400 kPa\"\nrows = 3\n", sand, sand_state);
  EXPECT_NEAR(r.rows[1][r.column("p")], 2e5, 1);
  EXPECT_NEAR(r.rows[2][r.column("p")], 3e5, 1);
  EXPECT_NEAR(r.rows[3][r.column("p")], 4e5, 1);
}

TEST(Driver, SegmentsFollowEachOther) {
  const auto r =
      run("[[segment]]\ntest = \"isotropic_compression\"\npressure = \"200 kPa\"\n[[segment]]\ntest = "
          "\"triaxial\"\ndrainage = \"drained\"\naxial_strain = 0.01\n",
          sand, sand_state);
  EXPECT_NEAR(last(r, "stress_yy"), 2e5, 0.5);
  EXPECT_NEAR(last(r, "time"), 2, 1e-12);
}

TEST(Driver, ReversalsGoThroughTheirTurningPoints) {
  const auto r = run(
      "[[segment]]\ntest = \"simple_shear\"\ndrainage = \"undrained\"\nreversals = [0.01, -0.01, 0.02]\nrows = 60\n",
      sand, sand_state);
  double most = 0, least = 0;
  for (const auto& row : r.rows) {
    most = std::max(most, row[r.column("strain_xy")]);
    least = std::min(least, row[r.column("strain_xy")]);
  }
  EXPECT_NEAR(least, -0.01, 1e-12);
  EXPECT_NEAR(most, 0.02, 1e-12);
  EXPECT_NEAR(last(r, "strain_xy"), 0.02, 1e-12);
}

TEST(Driver, StrainRateAndAccelerationMakeTheStrain) {
  const auto r =
      run("[[segment]]\nduration = \"2 s\"\nxy = { strain_rate = \"0.1 1/s\", strain_acceleration = \"0.3 1/s2\" }\nzz "
          "= { strain = 0.01 }\n");
  EXPECT_NEAR(last(r, "strain_xy"), 0.1 * 2 + 0.3 * 2 * 2 / 2, 1e-12);
  EXPECT_NEAR(last(r, "strain_rate_xy"), 0.1 + 0.3 * 2, 1e-12);
  EXPECT_NEAR(last(r, "strain_zz"), 0.01, 1e-14);
}

TEST(Driver, AStressThatCannotBeReachedEndsTheTestSaysWhichAndWhenAndKeepsTheRowsBefore) {
  const auto r =
      run("[[segment]]\nxx = { stress = \"900 kPa\" }\nyy = { stress = \"held\" }\nzz = { stress = \"held\" }\n", sand,
          sand_state);
  EXPECT_NE(r.failure.find("stress_"), std::string::npos) << r.failure;
  EXPECT_NE(r.failure.find("t = "), std::string::npos) << r.failure;
  EXPECT_GT(r.rows.size(), 10u);
  EXPECT_LT(last(r, "stress_xx"), 900e3);
}

TEST(Driver, RowsCanFollowALogarithmicAxis) {
  const auto r = run("[[segment]]\nduration = \"1 s\"\nfirst_row = \"1 ms\"\nrows = 4\nxx = { strain = 0.001 }\n");
  ASSERT_EQ(r.rows.size(), 5u);
  for (int row = 1; row <= 4; ++row) EXPECT_NEAR(r.rows[row][r.column("time")], std::pow(10, row - 4), 1e-12);
}

TEST(Driver, ALogarithmicAxisOfTimeDoesNotGoWithTurningPoints) {
  try {
    run("[[segment]]\ntest = \"simple_shear\"\ndrainage = \"undrained\"\nreversals = [0.01, -0.01]\n"
        "first_row = \"1 ms\"\n");
    ADD_FAILURE() << "nothing was said";
  } catch (const InputError& e) {
    EXPECT_NE(std::string(e.what()).find("first_row = \"1 ms\" and `reversals` exclude each other"), std::string::npos)
        << e.what();
  }
}

TEST(Driver, CollisionalStressAtTheStartStaysAsLongAsNothingIsAccelerated) {
  const std::string grains =
      "law = \"mu_i\"\nI_0 = 0.28\nrho_s = \"1090 kg/m3\"\nd = \"1 mm\"\nmu_s = 0.4245\nmu_d = 0.5718\nPhi_c = 0.62\n"
      "dPhi = 0.29\n";
  const std::string state =
      "background_pressure = \"1 kPa\"\nvoid_ratio = 0.8\ncollisional_stress = { yy = \"3 Pa\", xy = \"2 Pa\" }\n";
  const std::string shear =
      "[[segment]]\ntest = \"simple_shear\"\ndrainage = \"undrained\"\nshear_strain_rate = \"5 1/s\"\n";
  const auto r = run(shear, grains + "collisional_form = \"rate\"\n", state);
  EXPECT_NEAR(last(r, "stress_yy"), 3, 1e-9);
  EXPECT_NEAR(last(r, "stress_xy"), 2, 1e-9);
  EXPECT_THROW(run(shear, grains, state), InputError);  // the total form has no memory
}

TEST(Driver, RowsAreCountedInWhichCollisionsReturnWork) {
  // mu < 0.5718 < 1/sqrt 3: D.D returns work all along axisymmetric extension and never in compression
  const std::string grains =
      "law = \"granular\"" + sand.substr(sand.find('\n')) +
      "I_0 = 0.28\nrho_s = \"1090 kg/m3\"\nd = \"1 mm\"\nmu_s = 0.4245\nmu_d = 0.5718\nPhi_c = 0.62\n"
      "dPhi = 0.29\n";
  const auto n_returning = [&](const std::string& option, const char* strain) {
    return run(std::string("[[segment]]\ntest = \"triaxial\"\ndrainage = \"undrained\"\nrows = 4\naxial_strain = ") +
                   strain + "\n",
               grains + option, sand_state)
        .n_returning;
  };
  EXPECT_EQ(n_returning("", "-0.01"), 5);
  EXPECT_EQ(n_returning("", "0.01"), 0);
  EXPECT_EQ(n_returning("dispersive = \"isotropic\"\n", "-0.01"), 0);
}

TEST(Driver, AnImpossibleInitialStateIsRefused) {
  EXPECT_THROW(run("[[segment]]\ntest = \"oedometer\"\naxial_strain = 0.001\n", sand,
                   "stress = { xx = \"500 kPa\", yy = \"50 kPa\", zz = \"50 kPa\" }\nvoid_ratio = 0.8\n"),
               InputError);
}

TEST(Driver, ALawIsAskedOnlyForWhatItStartsFrom) {
  const std::string segment = "[[segment]]\ntest = \"oedometer\"\naxial_strain = 0.001\n";
  const std::string cone =
      "law = \"drucker_prager\"\nE = \"10 MPa\"\nnu = 0.25\nc = \"0 Pa\"\nphi = \"30 deg\"\npsi = \"0 deg\"\n";
  const std::string grains =
      "law = \"mu_i\"\nI_0 = 0.28\nrho_s = \"2500 kg/m3\"\nd = \"1 mm\"\nmu_s = 0.38\nmu_d = 0.66\nPhi_c = 0.7\ndPhi = "
      "0.29\n";
  const auto accepts = [&](const std::string& material, const std::string& initial) {
    try {
      read_element_test_text("test.toml",
                             "title = \"test\"\n[material]\n" + material + "[initial]\n" + initial + segment, ".");
    } catch (const InputError&) {
      return false;
    }
    return true;
  };
  const std::string p = "pressure = \"100 kPa\"\n", e = "void_ratio = 0.8\n", kappa = "kappa = 0.01\n";
  EXPECT_TRUE(accepts(cone, p));
  EXPECT_TRUE(accepts(cone, p + kappa));
  EXPECT_FALSE(accepts(cone, p + e));
  EXPECT_TRUE(accepts(sand, p + e));
  EXPECT_TRUE(accepts(sand, p + e + kappa));
  EXPECT_FALSE(accepts(sand, p));
  EXPECT_TRUE(accepts(grains, "background_" + p + e));
  EXPECT_FALSE(accepts(grains, p + e));
  EXPECT_FALSE(accepts(grains, "background_" + p + e + kappa));
}

TEST(Driver, TheFirstRowIsTheStateBeforeTheTest) {
  const auto r = run("[[segment]]\ntest = \"oedometer\"\naxial_strain = 0.001\n", sand, sand_state);
  EXPECT_EQ(r.rows[0][r.column("time")], 0);
  EXPECT_EQ(r.rows[0][r.column("p")], 1e5);
  EXPECT_EQ(r.rows[0][r.column("kappa")], 0);
  EXPECT_EQ(r.rows[0][r.column("phase")], 0);
}

}  // namespace talus::driver_test
