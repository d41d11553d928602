/// The areas that loads on sides of bodies act on.

#include "talus/mpm/start/surface_load.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "mpm/loads.hpp"

namespace talus::surface_load_test {

double total(const std::vector<double>& areas) {
  double sum = 0;
  for (double area : areas) sum += area;
  return sum;
}

class LoadedAreasInBothDimensions : public testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Dim, LoadedAreasInBothDimensions, testing::Values(2, 3),
                         [](const auto& p) { return std::to_string(p.param) + "d"; });

TEST_P(LoadedAreasInBothDimensions, AreTheWholeAreaOfASideOrAPartOfIt) {
  const int dim = GetParam();
  Case what = weightless(dim);
  const Filling filling = fill(what, what.bodies[0]);
  const double depth = dim == 3 ? 0.5 : 1;
  EXPECT_NEAR(total(loaded_areas(what, load(2 * dim - 1, {}), filling)), 0.5 * depth, 1e-12) << "top";
  EXPECT_NEAR(total(loaded_areas(what, load(x_min, {}), filling)), depth, 1e-12) << "left";
  // 0.13 m of the top, whose edges pass through particles
  SurfaceLoad part = load(2 * dim - 1, {});
  part.within = Box{{1.61, 0, 0}, {1.74, 4, 4}};
  EXPECT_NEAR(total(loaded_areas(what, part, filling)), 0.13 * depth, 1e-12);
  part.within = Box{{1.61, 0, 0}, {1.74, 2.4, 2.4}};  // ends below the top
  EXPECT_EQ(total(loaded_areas(what, part, filling)), 0);
}

TEST(LoadedAreas, AreThoseThatASideShowsAlongItsAxis) {
  // The top of a cylinder is a circle. Its particles share its exact volume.
  Case what = weightless(3);
  what.bodies[0].region = Cylinder{{2, 2, 1}, 0.5, 1};
  EXPECT_NEAR(total(loaded_areas(what, load(z_max, {}), fill(what, what.bodies[0]))), std::numbers::pi / 4, 1e-12);
  // Of sizes that are no multiples of the spacing, 0.05 m, all the same.
  what = weightless(2);
  what.bodies[0].region = Box{{1, 1, 0}, {1.49, 2.03, 0}};
  const Filling odd = fill(what, what.bodies[0]);
  EXPECT_NEAR(total(loaded_areas(what, load(y_max, {}), odd)), 0.49, 1e-12);
  EXPECT_NEAR(total(loaded_areas(what, load(x_max, {}), odd)), 1.03, 1e-12);
  // Parts of a row that a plane of symmetry cuts through its particles, and of rings around an axis.
  what = weightless(2);
  what.walls[0] = WallKind::symmetry;
  what.bodies[0].region = Box{{-0.525, 1, 0}, {0.525, 2, 0}};
  SurfaceLoad part = load(y_max, {});
  part.within = Box{{0, 0, 0}, {0.2, 3, 0}};
  EXPECT_NEAR(total(loaded_areas(what, part, fill(what, what.bodies[0]))), 0.2, 1e-12);
  what = weightless(2);
  what.axisymmetric = true;
  what.bodies[0].region = Box{{0, 1, 0}, {0.5, 2, 0}};
  part.within = Box{{0, 0, 0}, {0.075, 3, 0}};  // one ring and a half
  EXPECT_NEAR(total(loaded_areas(what, part, fill(what, what.bodies[0]))), 0.5 * 0.075 * 0.075, 1e-12);
  // Around an axis, per radian: a ring's top, its outside, its inside.
  what = weightless(2);
  what.axisymmetric = true;
  what.bodies[0].region = Box{{1, 1.5, 0}, {2, 2.5, 0}};
  const Filling ring = fill(what, what.bodies[0]);
  EXPECT_NEAR(total(loaded_areas(what, load(y_max, {}), ring)), 0.5 * (4 - 1), 1e-12);
  EXPECT_NEAR(total(loaded_areas(what, load(x_max, {}), ring)), 2, 1e-12);
  EXPECT_NEAR(total(loaded_areas(what, load(x_min, {}), ring)), 1, 1e-12);
  // Of a body that a plane of symmetry cuts, the part on this side; scattered particles keep their rows.
  what = weightless(2);
  what.walls[0] = WallKind::symmetry;
  what.bodies[0].region = Box{{-0.5, 1, 0}, {0.5, 2, 0}};
  what.bodies[0].scatter = 0.4;
  EXPECT_NEAR(total(loaded_areas(what, load(y_max, {}), fill(what, what.bodies[0]))), 0.5, 1e-12);
}

}  // namespace talus::surface_load_test
