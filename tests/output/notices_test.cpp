/// What the last lines of a run warn of.

#include "talus/output/notices.hpp"

#include <gtest/gtest.h>

namespace talus::notices_test {

std::vector<std::string> warnings(double numerical, double averaging, double kinetic = 0) {
  RunSummary run;
  run.ledger.turnover = 1;
  run.ledger.numerical = numerical;
  run.ledger.averaging = averaging;
  run.ledger.plastic = 1;
  run.ledger.kinetic = kinetic;
  run.ledger.initial = run.ledger.numerical + run.ledger.averaging + run.ledger.plastic + run.ledger.kinetic;
  return warnings_of(Case(), run);
}
bool one_begins(const std::vector<std::string>& all, const std::string& with) {
  return all.size() == 1 && all[0].starts_with(with);
}

TEST(Warnings, NothingIsSaidOfARunThatLosesALittle) { EXPECT_TRUE(warnings(0.1, 0.1).empty()); }

TEST(Warnings, MuchNumericalDissipationIsToldAndSoIsEnergyThatTheMethodWins) {
  EXPECT_TRUE(one_begins(warnings(0.2, 0.1), "Numerical dissipation is 30 %"));
  EXPECT_TRUE(one_begins(warnings(-0.05, 0.02), "The method created 3.0 %"));
  EXPECT_TRUE(warnings(-0.009, 0).empty());
}

TEST(Warnings, PressureThatIsMostlyNoiseIsTold) {
  RunSummary run;
  Case case_;
  run.noise = NoiseShares{0.4, 0.4};
  EXPECT_TRUE(warnings_of(case_, run).empty());
  run.noise = NoiseShares{0.8, 1.7};
  ASSERT_EQ(warnings_of(case_, run).size(), 1);
  EXPECT_NE(warnings_of(case_, run)[0].find("fluctuates by 80 % of its mean in time and by 170 %"), std::string::npos);
  EXPECT_NE(warnings_of(case_, run)[0].find("Use more particles per cell"), std::string::npos);
  case_.numerics.bulk_viscosity = 0;
  EXPECT_NE(warnings_of(case_, run)[0].find("bulk_viscosity = 0.4"), std::string::npos);
}

TEST(Warnings, WorkThatCollisionsReturnIsTold) {
  RunSummary run;
  run.ledger.turnover = run.ledger.initial = run.ledger.plastic = 1;
  run.ledger.returned = 0.009;
  EXPECT_TRUE(warnings_of(Case(), run).empty());
  run.ledger.returned = 0.034;
  EXPECT_TRUE(one_begins(warnings_of(Case(), run), "Collisions returned 3.4 % of the energy released"));
}

TEST(Warnings, OfGroundThatHasRestedNoSharesAreTold) {
  // 2 kg on cells of 0.1 m: a hundredth of a cell is worth 2 x 9.81 x 0.001 = 0.01962 J.
  Case case_;
  case_.cell = 0.1;
  case_.gravity = {0, -9.81, 0};
  RunSummary run;
  run.ledger.mass = 2;
  run.ledger.plastic = 1e-6;
  const auto said = [&](double turnover) {
    run.ledger.turnover = turnover;
    run.ledger.numerical = -0.5 * turnover;
    run.ledger.kinetic = 0.02 * turnover;
    run.ledger.initial = turnover;
    return warnings_of(case_, run).size();
  };
  EXPECT_EQ(said(0.0196), 0u);
  EXPECT_EQ(said(0.0197), 3u) << "the ledger does not close, the method wins, and it still moves";
}

TEST(Warnings, GrainsThatHaveJustBegunToFallAreApartAsTheyShouldBe) {
  Case case_;
  case_.cell = 0.1;
  case_.gravity = {0, -9.81, 0};
  RunSummary run;
  run.n_particles = run.ledger.n_separated = 100;
  run.ledger.mass = 2;
  run.ledger.turnover = run.ledger.kinetic = run.ledger.initial = 1e-3;
  EXPECT_TRUE(warnings_of(case_, run).empty());
  run.ledger.kinetic = 0;
  run.ledger.plastic = 1e-3;
  EXPECT_TRUE(one_begins(warnings_of(case_, run), "100 % of the particles carry no stress"));
}

TEST(Notices, OutflowIsToldWithItsPlaces) {
  RunSummary run;
  EXPECT_EQ(notice_of_outflow(run), "");
  run.ledger.mass = 30;
  run.ledger.outflow.mass = run.ledger.outflow.mass_through[1] = 10;
  EXPECT_EQ(notice_of_outflow(run),
            "10 kg, 25 % of the mass, have left through `outflow` sides (x_max 100 %). Fronts and heights are those of "
            "the material in the domain.");
  run.outflow.push_back({"x_max", "east side (x_max)", 10, 1, {600, 200}, {600, 190}, {600, 210}});
  EXPECT_EQ(
      notice_of_outflow(run),
      "10 kg, 25 % of the mass, have left the domain: 100 % over the east side (x_max), around (600, 200), along 20 "
      "m of it. Runout and deposit are those of the material in the domain.");
  // Places through which single particles left are counted, and not named.
  run.outflow[0].share = 0.99992;
  run.outflow.push_back({"y_max", "north side (y_max)", 8e-4, 8e-5, {600, 400}, {590, 400}, {610, 400}});
  EXPECT_NE(notice_of_outflow(run).find("along 20 m of it; and 1 further place, less than 0.01 % each. Runout"),
            std::string::npos)
      << notice_of_outflow(run);
  run.outflow.insert(run.outflow.begin(), 4, run.outflow[0]);
  EXPECT_NE(notice_of_outflow(run).find("along 20 m of it; and 2 further places. Runout"), std::string::npos)
      << notice_of_outflow(run);
}

TEST(Warnings, AMaterialThatStillMovesIsTold) {
  EXPECT_TRUE(one_begins(warnings(0, 0, 0.02), "The material still moves at the end"));
}

}  // namespace talus::notices_test
