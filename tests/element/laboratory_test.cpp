/// Tests as a laboratory runs them: combinations of stresses and strains, cycles, loops, stops, and its columns.

#include <gtest/gtest.h>

#include <cmath>
#include <fstream>

#include "talus/base/error.hpp"
#include "talus/element/driver.hpp"
#include "talus/input/read.hpp"

namespace talus::laboratory_test {

const std::string elastic = "law = \"linear_elastic\"\nE = \"10 MPa\"\nnu = 0.25\n";
const std::string sand =
    "law = \"simsand\"\nE0 = 50\nnu = 0.15\nn = 0.6\nphi_c = \"31.3 deg\"\ne_ref = 1.05\nLambda = 0.0579\nxi = "
    "0.4\nA_d = "
    "2\nk_p = 0.01\nn_p = 2.4\nn_d = 2.9\n";
const std::string dense = "pressure = \"100 kPa\"\nvoid_ratio = 0.85\n";

ElementTestFile read(const std::string& segments, const std::string& material = elastic,
                     const std::string& state = "pressure = \"100 kPa\"\n") {
  return read_element_test_text("it.toml",
                                "title = \"test\"\n[material]\n" + material + "[initial]\n" + state + segments, ".");
}
ElementResult run(const std::string& segments, const std::string& material = elastic,
                  const std::string& state = "pressure = \"100 kPa\"\n") {
  return run_element_test(read(segments, material, state).test);
}
double last(const ElementResult& r, const std::string& name) { return r.rows.back().at(r.column(name)); }

/// What is said about wrong segments.
std::string refusal(const std::string& segments, const std::string& material = elastic,
                    const std::string& state = "pressure = \"100 kPa\"\n") {
  try {
    read(segments, material, state);
  } catch (const InputError& e) {
    return e.what();
  }
  return "nothing";
}
#define EXPECT_SAYS(said, expected) EXPECT_NE((said).find(expected), std::string::npos) << (said)

TEST(Laboratory, AStressPathHoldsACombinationOfStresses) {
  const auto r =
      run("[[segment]]\nxx = { stress = \"200 kPa\" }\nyy = { combination = { stress_yy = 1, stress_xx = -0.35 } }\n"
          "zz = { combination = { stress_zz = 1, stress_xx = -0.35 } }\n",
          sand, dense);
  ASSERT_EQ(r.failure, "");
  EXPECT_NEAR(last(r, "stress_yy"), 1e5 + 0.35 * 1e5, 0.01);
  EXPECT_NEAR(last(r, "stress_zz"), 1e5 + 0.35 * 1e5, 0.01);
}

TEST(Laboratory, ACombinationOfAStressAndAStrainIsASpring) {
  // Constant normal stiffness: sigma_yy + k eps_yy stays, while xx is compressed. Elastic: sigma_yy = l (a + b) + 2 G b with
  // l = 2 G = E/(1 + nu) = 8 MPa x nu/(1 - 2 nu) = 4 MPa, so (l + 2 G + k) b = -l a.
  const auto r =
      run("[[segment]]\nxx = { strain = \"1 %\" }\n"
          "yy = { combination = { stress_yy = 1, strain_yy = \"10 MPa\" } }\n");
  ASSERT_EQ(r.failure, "");
  EXPECT_NEAR(last(r, "strain_yy"), -4e6 * 0.01 / (4e6 + 8e6 + 10e6), 1e-9);
}

TEST(Laboratory, ACombinationOfStrainsFollowsItsChange) {
  const auto r =
      run("[[segment]]\nxx = { strain = \"1 %\" }\n"
          "yy = { combination = { strain_xx = 1, strain_yy = 1, strain_zz = 1 }, change = \"-0.5 %\" }\n");
  EXPECT_NEAR(last(r, "strain_yy"), -0.015, 1e-12);
  EXPECT_NEAR(last(r, "volumetric_strain"), -0.5, 1e-10);  // in percent
}

TEST(Laboratory, TargetsOfDeviatorStressAreSigned) {
  for (const double q : {30e3, -20e3}) {
    const auto r =
        run("[[segment]]\ntest = \"triaxial\"\ndrainage = \"drained\"\nq = \"" + std::to_string(q) + " Pa\"\n", sand,
            dense);
    ASSERT_EQ(r.failure, "");
    EXPECT_NEAR(last(r, "q_signed"), q, 0.01);
    EXPECT_NEAR(last(r, "stress_xx") - last(r, "stress_yy"), q, 0.01);
    EXPECT_NEAR(last(r, "eta"), q / (1e5 + q / 3), 1e-6);
  }
}

TEST(Laboratory, CyclesTurnAtAStress) {
  for (const char* drainage : {"drained", "undrained"}) {
    const auto r =
        run(std::string("[[segment]]\ntest = \"triaxial\"\ndrainage = \"") + drainage +
                "\"\naxial_strain_rate = \"1e-3 1/s\"\nq_between = [\"40 kPa\", \"-20 kPa\"]\ncycles = 3\nrows = 60\n",
            sand, dense);
    ASSERT_EQ(r.failure, "");
    ASSERT_EQ(r.rows.size(), 61u);
    for (int way = 0; way < 6; ++way) {
      const auto& turn = r.rows[10 * (way + 1)];
      EXPECT_NEAR(turn[r.column("q_signed")], way % 2 == 0 ? 40e3 : -20e3, 1);
    }
  }
}

TEST(Laboratory, CyclesOfShearTurnAtAShearStress) {
  const auto r = run(
      "[[segment]]\ntest = \"simple_shear\"\ndrainage = \"constant_normal_stress\"\nshear_strain_rate = \"1e-3 1/s\"\n"
      "shear_stress_between = [\"-15 kPa\", \"25 kPa\"]\ncycles = 2\nrows = 8\n",
      sand, dense);
  ASSERT_EQ(r.failure, "");
  EXPECT_NEAR(r.rows[2][r.column("stress_xy")], -15e3, 1);
  EXPECT_NEAR(last(r, "stress_xy"), 25e3, 1);
  EXPECT_NEAR(last(r, "stress_yy"), 1e5, 0.1);
}

TEST(Laboratory, CyclesTurnAtAStrain) {
  const auto r =
      run("[[segment]]\ntest = \"triaxial\"\ndrainage = \"undrained\"\naxial_strain_between = [\"0.5 %\", \"-0.5 %\"]\n"
          "cycles = 4\nrows = 150\nduration = \"15 s\"\n",
          sand, dense);
  double most = 0, least = 0;
  for (const auto& row : r.rows) {
    most = std::max(most, row[r.column("axial_strain")]);
    least = std::min(least, row[r.column("axial_strain")]);
  }
  EXPECT_NEAR(most, 0.5, 1e-9);
  EXPECT_NEAR(least, -0.5, 1e-9);
  EXPECT_NEAR(last(r, "axial_strain"), -0.5, 1e-9);
  EXPECT_NEAR(last(r, "time"), 15, 1e-9);
}

TEST(Laboratory, AnUndrainedTestHoldsTheLateralTotalStressAndThePorePressureFollows) {
  const auto r =
      run("[[segment]]\ntest = \"triaxial\"\ndrainage = \"undrained\"\naxial_strain = \"3 %\"\n[[segment]]\ntest = "
          "\"triaxial\"\ndrainage = \"drained\"\naxial_strain = \"-0.1 %\"\n",
          sand, "pressure = \"100 kPa\"\nvoid_ratio = 0.95\npore_pressure = \"200 kPa\"\n");
  ASSERT_EQ(r.failure, "");
  for (int i = 0; i <= 100; ++i)
    EXPECT_NEAR(r.rows[i][r.column("stress_yy")] + r.rows[i][r.column("pore_pressure")], 300e3, 1e-6);
  EXPECT_GT(r.rows[100][r.column("pore_pressure")], 210e3);  // sand as loose as this contracts at first
  EXPECT_EQ(last(r, "pore_pressure"), r.rows[100][r.column("pore_pressure")]);  // drained: it stays
}

TEST(Laboratory, AStopEndsASegmentWhereItsValueIsReached) {
  const std::string compress =
      "[[segment]]\ntest = \"triaxial\"\ndrainage = \"drained\"\naxial_strain = \"10 %\"\nrows = 10\n";
  const auto r = run(
      compress + "stop = { q = \"50 kPa\", axial_strain = 0.09 }\n" + compress + "stop = { eta = 0.2 }\n", sand, dense);
  ASSERT_EQ(r.failure, "");
  ASSERT_EQ(r.rows.size(), 21u);
  EXPECT_NEAR(r.rows[10][r.column("q_signed")], 50e3, 1);
  EXPECT_LT(r.rows[10][r.column("axial_strain")], 9);
  EXPECT_NEAR(r.rows[5][r.column("time")], r.rows[10][r.column("time")] / 2, 1e-12);  // rows divide what is run
  EXPECT_GT(last(r, "axial_strain"), 9);  // eta grows: 0.2 is not reached again
}

TEST(Laboratory, AStopEndsAllCyclesOfItsSegment) {
  const auto r =
      run("[[segment]]\ntest = \"triaxial\"\ndrainage = \"undrained\"\naxial_strain_rate = \"1e-3 1/s\"\n"
          "q_between = [\"20 kPa\", \"-20 kPa\"]\ncycles = 200\nstop = { p = \"70 kPa\" }\nrows = "
          "4000\n[[segment]]\nduration = \"1 s\"\n"
          "xx = { strain = 0 }\nrows = 1\n",
          sand, "pressure = \"100 kPa\"\nvoid_ratio = 0.98\n");
  ASSERT_EQ(r.failure, "");
  EXPECT_LT(r.rows.size(), 3900u);
  EXPECT_NEAR(last(r, "p"), 70e3, 10);
}

TEST(Laboratory, ATurningStressOutOfReachEndsTheTestAndIsNamed) {
  const auto r =
      run("[[segment]]\ntest = \"triaxial\"\ndrainage = \"drained\"\naxial_strain_rate = \"1e-3 1/s\"\n"
          "q_between = [\"900 kPa\", \"0 kPa\"]\nlongest_way = \"20 %\"\n",
          sand, dense);
  EXPECT_SAYS(r.failure, "turning point 9e+05 Pa");
}

TEST(Laboratory, SegmentsRepeat) {
  const std::string way =
      "[[segment]]\nrows = 2\nxx = { strain = \"1 %\" }\n[[segment]]\nrows = 2\nxx = { strain = \"-0.5 %\" }\n";
  EXPECT_NEAR(last(run(way + "repeat = 4\nrepeat_segments = 2\n"), "strain_xx"), 4 * 0.005, 1e-12);
  EXPECT_NEAR(last(run(way + "repeat = 4\n"), "strain_xx"), 0.01 - 4 * 0.005, 1e-12);
  EXPECT_EQ(run(way + "repeat = 4\nrepeat_segments = 2\n").rows.size(), 17u);
}

TEST(Laboratory, StrainsMayBeGivenInPercent) {
  for (const char* strain : {"0.01", "\"1 %\"", "\"1%\""})
    EXPECT_EQ(last(run(std::string("[[segment]]\ntest = \"oedometer\"\naxial_strain = ") + strain + "\n"), "strain_yy"),
              0.01);
  EXPECT_SAYS(refusal("[[segment]]\ntest = \"oedometer\"\naxial_strain = \"1 mm\"\n"),
              "is not a strain; write \"5 %\"");
  EXPECT_SAYS(refusal("[[segment]]\ntest = \"oedometer\"\naxial_strain = 0.1\n", sand,
                      "pressure = \"1 kPa\"\nvoid_ratio = \"80 %\"\n"),
              "is not a plain number");
}

TEST(Laboratory, CombinationsThatFollowFromOtherComponentsAreRefused) {
  const std::string follows = "follows from the other components", segment = "[[segment]]\n";
  // yy has nothing to control: the strain of xx is that of xx, or constant.
  EXPECT_SAYS(refusal(segment + "xx = { strain = 0.1 }\nyy = { combination = { strain_xx = 1 } }\n"), follows);
  EXPECT_SAYS(refusal(segment + "yy = { combination = { strain_xx = 1, strain_zz = 2 } }\n"),
              "it.toml:9:6: segment[0].yy");
  EXPECT_SAYS(refusal(segment + "xx = { stress = \"held\" }\nyy = { combination = { stress_xx = 3 } }\n"), follows);
  // Two with the same combination, and three of which one is the sum of the others.
  EXPECT_SAYS(refusal(segment + "xx = { combination = { strain_xx = 1, strain_yy = 1 } }\n"
                                "yy = { combination = { strain_xx = 2, strain_yy = 2 }, change = \"1 %\" }\n"),
              follows);
  EXPECT_SAYS(refusal(segment + "xx = { combination = { stress_xx = 1, stress_yy = -1 } }\n"
                                "yy = { combination = { stress_yy = 1, stress_zz = -1 } }\n"
                                "zz = { combination = { stress_xx = 1, stress_zz = -1 } }\n"),
              follows);
  // Stiffnesses of any size beside stresses are independent of each other.
  for (const char* stiffness : {"1 Pa", "10 MPa", "1e6 MPa"})
    EXPECT_EQ(refusal(segment + "xx = { combination = { stress_xx = 1, strain_zz = \"" + stiffness +
                      "\" } }\nyy = { combination = { stress_yy = 1, strain_zz = \"" + stiffness + "\" } }\n"),
              "nothing");
}

TEST(Laboratory, WrongCombinationsCyclesLoopsAndStopsAreRefused) {
  EXPECT_SAYS(refusal("[[segment]]\nyy = { combination = {} }\n"), "needs a factor other than 0");
  EXPECT_SAYS(refusal("[[segment]]\nyy = { combination = { stress_yy = 1 }, change = 0.1 }\n"), "lacks its unit");
  EXPECT_SAYS(refusal("[[segment]]\nyy = { combination = { strain_yy = 1 }, rate = \"1 kPa/s\" }\n"), "yy.rate");
  EXPECT_SAYS(refusal("[[segment]]\nyy = { combination = { stress_yy = 1 }, change = \"1 Pa\", rate = \"1 Pa/s\" }\n"),
              "exclude each other");
  EXPECT_SAYS(refusal("[[segment]]\nyy = { combination = { stress_yy = 1 }, strain = 0.1 }\n"), "exclude each other");
  EXPECT_SAYS(refusal("[[segment]]\nyy = { combination = { stress_yx = 1, stress_yy = 1 } }\n"),
              "is no key of a combination");
  const std::string triaxial = "[[segment]]\ntest = \"triaxial\"\ndrainage = \"drained\"\n";
  EXPECT_SAYS(refusal(triaxial + "q_between = [\"1 kPa\", \"2 kPa\"]\n"), "need `axial_strain_rate`");
  EXPECT_SAYS(refusal(triaxial + "axial_strain_between = [0.1, 0.1]\n"), "two different values");
  EXPECT_SAYS(refusal(triaxial + "axial_strain_between = [0.1, 0]\naxial_strain = 0.1\n"), "and nothing else");
  EXPECT_SAYS(refusal(triaxial + "axial_strain = 0.1\ncycles = 3\n"), "cycles is no key of");
  EXPECT_SAYS(refusal(triaxial + "axial_stress = \"1 kPa\"\nq = \"1 kPa\"\n"), "exclude each other");
  EXPECT_SAYS(refusal(triaxial + "axial_strain = 0.1\nrepeat_segments = 2\n"), "needs `repeat`");
  EXPECT_SAYS(refusal(triaxial + "axial_strain = 0.1\nrepeat = 2\nrepeat_segments = 2\n"),
              "exceeds the number of segments");
  EXPECT_SAYS(refusal(triaxial + "axial_strain = 0.1\nrepeat = 1000000\nrows = 1000\n"), "`rows`");
  EXPECT_SAYS(refusal(triaxial + "axial_strain = 0.1\nstop = { tau = \"1 kPa\" }\n"), "is no key of a stop condition");
}

TEST(Laboratory, StrainsAndStressesWithoutMeaningAreRefused) {
  EXPECT_SAYS(refusal("[[segment]]\ntest = \"oedometer\"\naxial_strain = 1e300\n"), "at most 100 is possible");
  EXPECT_SAYS(refusal("[[segment]]\nxy = { strain_rate = \"1e300 1/s\" }\n"), "at most 1e+06 is possible");
  EXPECT_SAYS(refusal("[[segment]]\nxx = { strain = 0.1 }\n", elastic, "pressure = \"1e300 kPa\"\n"),
              "is out of range");
  const auto r = run("[[segment]]\nxx = { strain = 0.1 }\n", "law = \"linear_elastic\"\nE = \"1e308 Pa\"\nnu = 0.49\n");
  EXPECT_SAYS(r.failure, "is not finite");
}

TEST(Laboratory, AMisspeltLawOrTestIsTheOnlyComplaint) {
  const std::string law = refusal("[[segment]]\ntest = \"oedometer\"\naxial_strain = 0.1\n",
                                  "law = \"simsant\"\nE0 = 50\nnu = 0.15\n", dense);
  EXPECT_SAYS(law, "did you mean `simsand`?");
  EXPECT_EQ(law.find('\n'), std::string::npos) << law;
  const std::string test =
      refusal("[[segment]]\ntest = \"triaxal\"\ndrainage = \"drained\"\naxial_strain = 0.1\naxis = \"z\"\n");
  EXPECT_SAYS(test, "did you mean `triaxial`?");
  EXPECT_EQ(test.find('\n'), std::string::npos) << test;
}

TEST(Laboratory, ATableWhoseInstantsDifferFromRowsInTheLastDigitIsFollowed) {
  const std::string path = testing::TempDir() + "/talus_rates.csv";
  {
    std::ofstream table(path);
    table << "time,rate_xy\n0,0.01\n0.10999999999999999,0.02\n0.22,0.01\n";
  }
  // rows at 0.22 i/4: the second one, 0.11, is one digit after the instant
  const auto r = run("[[segment]]\nrates = \"" + path + "\"\nrows = 4\nyy = { stress = \"held\" }\n", sand, dense);
  ASSERT_EQ(r.failure, "");
  ASSERT_EQ(r.rows.size(), 5u);
  EXPECT_NEAR(last(r, "strain_xy"), 0.015 * 0.22, 1e-12);
}

}  // namespace talus::laboratory_test
