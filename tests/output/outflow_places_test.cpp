/// Places on the map where material has left.

#include "talus/output/outflow_places.hpp"

#include <gtest/gtest.h>

namespace talus::outflow_places_test {

/// A domain of 600 m x 400 m whose corner lies at (640000, 5190000).
Case valley() {
  Case case_;
  case_.dim = 3;
  case_.domain = {{0, 0, 0}, {600, 400, 300}};
  case_.map = MapOfCase{};
  case_.map->frame.origin = {640000, 5190000};
  return case_;
}

Outflow some() {
  Outflow out;
  out.places[1].add(3, {600.4, 190});  // a little beyond the eastern side
  out.places[1].add(3, {600.2, 210});
  out.places[place_of_gap(0)].add(1, {50, 60});
  out.places[place_of_gap(0)].add(3, {58, 62});
  out.mass = 10;
  return out;
}

TEST(OutflowPlaces, HaveTheCoordinatesOfTheMapAndLieOnTheSide) {
  const std::vector<OutflowOnMap> places = outflow_on_map(valley(), some());
  ASSERT_EQ(places.size(), 2u);
  EXPECT_EQ(places[0].name, "east side (x_max)") << "most has left there";
  EXPECT_DOUBLE_EQ(places[0].mass, 6);
  EXPECT_DOUBLE_EQ(places[0].share, 0.6);
  EXPECT_EQ(places[0].middle, (Vec<2>{640600, 5190200}));
  EXPECT_EQ(places[0].low, (Vec<2>{640600, 5190190}));
  EXPECT_EQ(places[0].length(), 20);
  EXPECT_EQ(places[1].name, "gap 1");
  EXPECT_EQ(places[1].middle, (Vec<2>{640056, 5190061.5}));
  EXPECT_EQ(places[1].length(), 8);
  EXPECT_EQ(in_words(places[0]), "60 % over the east side (x_max), around (640600, 5190200), along 20 m of it");
  EXPECT_EQ(in_words(places[1]),
            "40 % over ground without heights (gap 1), around (640056, 5190062), within 8 m x 2 m");
}

TEST(OutflowPlaces, GapsBeyondTheFifteenthAreOnePlace) {
  Outflow out;
  for (int gap = 0; gap < 30; ++gap) out.places[place_of_gap(gap)].add(1, {double(gap), 0});
  out.mass = 30;
  const std::vector<OutflowOnMap> places = outflow_on_map(valley(), out);
  ASSERT_EQ(places.size(), 16u);
  EXPECT_EQ(places[0].name, "further gaps");
  EXPECT_DOUBLE_EQ(places[0].mass, 15);
}

TEST(OutflowPlaces, AreNoneWithoutTerrain) {
  EXPECT_TRUE(outflow_on_map(Case(), some()).empty());
  EXPECT_TRUE(outflow_on_map(valley(), Outflow()).empty());
}

}  // namespace talus::outflow_places_test
