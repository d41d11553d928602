#include "talus/output/gauges.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <numbers>
#include <random>

#include "folder_of_its_own.hpp"

namespace talus::gauges_test {

/// A plane that falls by 0.75 towards the east, 200 m x 120 m: the cosine of its slope is 0.8.
Case slope(std::vector<Gauge> gauges) {
  Case what;
  what.dim = 3;
  PlanRaster heights = PlanRaster::of({0, 0}, 5, 40, 24, 0);
  for (int row = 0; row < 24; ++row)
    for (int column = 0; column < 40; ++column) heights.at(column, row) = -0.75 * heights.middle(column, row)[0];
  what.map = MapOfCase{std::make_shared<const Terrain>(heights), {{500000, 5000000}, ""}, false};
  what.output.maps = {0.1, 0.5, 5, {}};
  what.gauges = std::move(gauges);
  return what;
}

/// All of the slope under a slab 3 m thick upright that slides with one velocity: points half a metre apart.
FlowPoints slab(Vec<3> velocity) {
  FlowPoints p;
  for (int i = 0; i < 400; ++i)
    for (int j = 0; j < 240; ++j) {
      p.places.push_back({0.25 + 0.5 * i, 0.25 + 0.5 * j, 0});
      p.velocities.push_back(velocity);
    }
  // Six points above one another are one that is as wide, and has their mass.
  for (int k = 0; k < 5; ++k) {
    const std::size_t n = 400 * 240;
    p.places.insert(p.places.end(), p.places.begin(), p.places.begin() + n);
    p.velocities.insert(p.velocities.end(), n, velocity);
  }
  p.volumes.assign(p.places.size(), 0.125);
  p.masses.assign(p.places.size(), 0.125 * 1800);
  return p;
}

class GaugesOnASlope : public FolderOfItsOwn {
 protected:
  std::string csv() const {
    std::ifstream in(folder_ / "gauges.csv");
    return {std::istreambuf_iterator<char>(in), {}};
  }
};

TEST_F(GaugesOnASlope, AtAPlaceASlidingSlabHasItsThicknessSpeedAndPressure) {
  const Vec<3> v{8, -6, -6};
  // In the middle of a pixel, and at a place that has nothing to do with pixels.
  for (const Vec<2>& x : {Vec<2>{62.5, 52.5}, Vec<2>{91.3, 33.7}}) {
    const Case what = slope({{"house", {x}}});
    const GaugeReading r = FlowGauge(what, what.gauges[0]).read(slab(v));
    EXPECT_NEAR(r.vertical_thickness, 3, 1e-12);
    EXPECT_NEAR(r.thickness, 3 * 0.8, 1e-9);
    EXPECT_NEAR(r.speed, std::sqrt(136), 1e-12);
    EXPECT_NEAR(r.pressure, 1800 * 136, 1e-8);
    for (int a = 0; a < 3; ++a) EXPECT_NEAR(r.velocity[a], v[a], 1e-12);
    EXPECT_EQ(r.flux, 0);
  }
}

TEST_F(GaugesOnASlope, InTheMiddleOfAPixelItHasTheNumbersOfTheMap) {
  const Case what = slope({{"house", {{62.5, 52.5}}}});
  FlowPoints p;
  std::mt19937 random(1);
  std::uniform_real_distribution<double> x(50, 75), y(40, 65), v(-10, 10), volume(1, 30);
  for (int i = 0; i < 200; ++i) {
    p.places.push_back({x(random), y(random), 0});
    p.velocities.push_back({v(random), v(random), v(random)});
    p.volumes.push_back(volume(random));
    p.masses.push_back(1000 * volume(random));
  }
  FlowMaps maps(*what.map->ground, PlanRaster::of({0, 0}, 5, 40, 24), 1, 0.5);
  const FlowMap map = maps.now(p);
  const GaugeReading r = FlowGauge(what, what.gauges[0]).read(p);
  EXPECT_NEAR(r.thickness, map.thickness.at(12, 10), 1e-12);
  EXPECT_NEAR(r.speed, map.speed.at(12, 10), 1e-12);
  EXPECT_NEAR(r.pressure, map.pressure.at(12, 10), 1e-7);
}

TEST_F(GaugesOnASlope, TheFluxOfASlabIsUprightThicknessTimesVelocityAcrossTheLine) {
  const Vec<3> v{8, -6, -6};
  // From the left bank to the right one: downstream, to the east, is positive. The velocity across is 8 m/s.
  const Case what =
      slope({{"down", {{90, 100}, {90, 20}}}, {"up", {{90, 20}, {90, 100}}}, {"oblique", {{60, 90}, {120, 10}}}});
  const GaugeReading down = FlowGauge(what, what.gauges[0]).read(slab(v)),
                     up = FlowGauge(what, what.gauges[1]).read(slab(v)),
                     oblique = FlowGauge(what, what.gauges[2]).read(slab(v));
  EXPECT_NEAR(down.flux, 3 * 8 * 80, 1e-8);
  EXPECT_NEAR(up.flux, -3 * 8 * 80, 1e-8);
  EXPECT_NEAR(down.width, 80, 1e-9);
  EXPECT_NEAR(down.mean_thickness, 2.4, 1e-9);
  EXPECT_NEAR(down.mean_speed, std::sqrt(136), 1e-11);
  EXPECT_NEAR(down.speed, std::sqrt(136), 1e-11);
  // The way is (0.6, -0.8), its left (0.8, 0.6): 0.8 x 8 - 0.6 x 6 = 2.8 m/s through 100 m. Squares that lie along the
  // line do not tile the plane if they stand in rows towards the east.
  EXPECT_NEAR(oblique.flux, 3 * 2.8 * 100, 0.005 * 840);
}

/// A crowd of points at some time: each keeps its own velocity, all pass from the west to the east.
FlowPoints crowd(double time) {
  FlowPoints p;
  std::mt19937 random(3);
  std::uniform_real_distribution<double> x(20, 50), y(45, 75), east(8, 20), north(-2, 2), volume(0.5, 8);
  for (int i = 0; i < 2000; ++i) {
    const Vec<3> begin{x(random), y(random), 0}, v{east(random), north(random), 0};
    p.places.push_back(begin + time * v);
    p.velocities.push_back(v);
    p.volumes.push_back(volume(random));
    p.masses.push_back(2000 * p.volumes.back());
  }
  return p;
}

TEST_F(GaugesOnASlope, TheVolumeThatHasCrossedALineIsThatOfTheFlow) {
  Gauges gauges(folder_ / "gauges.csv", slope({{"straight", {{100, 119}, {100, 1}}},
                                               {"oblique", {{75, 118}, {125, 2}}},
                                               {"back", {{125, 2}, {75, 118}}},
                                               {"bent", {{85, 118}, {105, 60}, {85, 2}}},
                                               {"aside", {{100, 119}, {100, 110}}}}));
  double volume = 0;
  for (const double v : crowd(0).volumes) volume += v;
  // The slowest have gone 95 m at the end. At 20 m/s a point goes 4 m from instant to instant, less than a pixel.
  for (int i = 0; i <= 60; ++i) gauges.add(0.2 * i, crowd(0.2 * i), i % 5 == 0);
  const std::vector<GaugeSummary>& s = gauges.summaries();
  EXPECT_NEAR(s[0].volume / volume, 1, 0.003);
  EXPECT_NEAR(s[1].volume / volume, 1, 0.003);
  EXPECT_NEAR(s[2].volume, -s[1].volume, 1e-9 * volume);
  EXPECT_NEAR(s[3].volume / volume, 1, 0.01);
  EXPECT_EQ(s[4].volume, 0);
  EXPECT_FALSE(s[4].arrival);
  EXPECT_LT(s[2].flux, 0);  // the largest has its sign
  // The first rows of points: from x = 50 m at 20 m/s in 2.5 s at the earliest, less half a column and half a point.
  ASSERT_TRUE(s[0].arrival);
  EXPECT_GT(*s[0].arrival, 2.2);
  EXPECT_LT(*s[0].arrival, 3.5);
}

TEST_F(GaugesOnASlope, StoppedAndResumedTheFileIsThatOfAnUnbrokenRun) {
  const Case what = slope({{"house", {{110, 60}}}, {"line", {{100, 110}, {100, 10}}}});
  const auto add = [&](Gauges& gauges, int begin, int end) {
    for (int i = begin; i < end; ++i) gauges.add(0.1 * i, crowd(0.1 * i), i % 3 == 0);
  };
  std::vector<double> state;
  std::string whole;
  {
    Gauges gauges(folder_ / "gauges.csv", what);
    add(gauges, 0, 90);
    state = gauges.state();
    whole = csv();
  }
  EXPECT_TRUE(std::ranges::all_of(state, [](double x) { return std::isfinite(x); }));  // JSON knows no NaN
  std::vector<double> half;
  long bytes = 0;
  {
    Gauges gauges(folder_ / "gauges.csv", what);
    add(gauges, 0, 41);
    half = gauges.state();
    bytes = gauges.bytes();
    add(gauges, 41, 50);  // written after the checkpoint: lost
  }
  Gauges gauges(folder_ / "gauges.csv", what, half, bytes);
  add(gauges, 41, 90);
  EXPECT_EQ(gauges.state(), state);
  EXPECT_EQ(csv(), whole);
  EXPECT_THROW(Gauges(folder_ / "gauges.csv", slope({{"house", {{110, 60}}}}), state, bytes), std::runtime_error);
}

TEST_F(GaugesOnASlope, WhereNothingFlowsThereIsThicknessZeroAndNoSpeed) {
  Gauges gauges(folder_ / "gauges.csv", slope({{"house", {{110, 60}}}}));
  gauges.add(0, {}, true);
  EXPECT_EQ(csv(),
            "time [s],house.thickness [m],house.vertical_thickness [m],house.speed [m/s],house.velocity_east [m/s],"
            "house.velocity_north [m/s],house.velocity_up [m/s],house.direction [deg],house.pressure [kPa]\n"
            "0,0,0,nan,nan,nan,nan,nan,nan\n");
  EXPECT_EQ(gauges.charts().size(), 2u);
  EXPECT_EQ(gauges.charts()[0].csv, "gauges.csv");
}

TEST_F(GaugesOnASlope, ACaseWithoutGaugesWritesNoFile) {
  Gauges gauges(folder_ / "gauges.csv", slope({}));
  gauges.add(0, slab({}), true);
  EXPECT_FALSE(gauges.any());
  EXPECT_TRUE(gauges.state().empty());
  EXPECT_FALSE(std::filesystem::exists(folder_ / "gauges.csv"));
}

}  // namespace talus::gauges_test
