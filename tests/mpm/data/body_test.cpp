/// The particles of a body in one tile.

#include "talus/mpm/data/body.hpp"

#include <gtest/gtest.h>

#include "mpm/by_hand.hpp"

namespace talus::body_test {

TEST(TilePoints, AreTheParticlesOfTheTilesRange) {
  ShapedBody<2, Ugimp> body{{"body", 1, LinearElastic{1, 0}, particles_at<2>(std::vector<Vec<2>>(11)), {}},
                            Ugimp(0.25)};
  body.tiles = {{0, 4}, {4, 11}};
  const auto points = points_of(body, {{3, 5}, {}, true}, 1);
  EXPECT_EQ(points.size(), 7);
  EXPECT_EQ(points.tile, (Index<2>{3, 5}));
  EXPECT_EQ(points.shape.half_width, 0.25);
  EXPECT_EQ(points.particles.ids(points.range.begin).id, 4);
  EXPECT_EQ(points.count(0), 4) << "four at a time";
  EXPECT_EQ(points.count(4), 3) << "and what is left";
}

}  // namespace talus::body_test
