/// What is wrong with a case that shows only with its particles.

#include "talus/mpm/start/check_start.hpp"

#include <gtest/gtest.h>

#include "mpm/cases.hpp"
#include "talus/case/resolve.hpp"

namespace talus::check_start_test {

/// What is said of the block of rubber that cases.hpp makes, after a change.
template <class F>
std::vector<std::string> said_of(F change) {
  Case what = block(2, rubber(), 1000);
  what.bodies[0].material = 0;
  change(what);
  const Resolved resolved = resolve_read(what);
  std::vector<std::string> all;
  for (const Mistake& m : resolved.mistakes) all.push_back("resolve: " + m.text);
  if (all.empty())
    for (const Mistake& m : check_start(resolved.case_)) all.push_back(m.text);
  return all;
}
void expect_one(const std::vector<std::string>& said, const std::string& part) {
  ASSERT_EQ(said.size(), 1) << (said.empty() ? part : said[0]);
  EXPECT_NE(said[0].find(part), std::string::npos) << said[0];
}

TEST(CheckStart, OfABlockInTheOpenThereIsNothingToSay) {
  EXPECT_TRUE(said_of([](Case&) {}).empty());
}

TEST(CheckStart, ABodyThinnerThanItsSpacingHoldsNoParticles) {
  // Rows of the lattice stand at odd multiples of half a spacing, 0.025 m: between 1.53 and 1.54 m there is none.
  expect_one(said_of([](Case& c) { c.bodies[0].region = Box{{1.53, 1.5, 0}, {1.54, 2.5, 0}}; }), "no particles");
}

TEST(CheckStart, BodiesThatShareGroundAreTold) {
  const std::vector<std::string> said = said_of([](Case& c) {
    c.bodies.push_back(c.bodies[0]);
    c.bodies[1].name = "second";
    c.bodies[1].region = Box{{1.9, 2.4, 0}, {2.4, 3, 0}};
  });
  ASSERT_EQ(said.size(), 2) << "each of the other";
  for (const std::string& one : said) EXPECT_NE(one.find("overlaps body"), std::string::npos) << one;
  EXPECT_TRUE(said_of([](Case& c) {
                c.bodies.push_back(c.bodies[0]);
                c.bodies[1].name = "second";
                c.bodies[1].region = Box{{2, 1.5, 0}, {2.5, 2.5, 0}};
              }).empty())
      << "bodies that touch do not";
}

TEST(CheckStart, ALoadThatFindsNothingOfItsSideIsTold) {
  const auto pressed = [](double top) {
    return said_of([&](Case& c) {
      SurfaceLoad load;
      load.name = "plate";
      load.side = 3;
      load.traction = {0, -1, 0};
      load.within = Box{{1, 1, 0}, {3, top, 0}};
      c.loads = {load};
    });
  };
  EXPECT_TRUE(pressed(3).empty()) << "the top, 2.5 m, is in it";
  expect_one(pressed(2.4), "holds nothing of side");
}

}  // namespace talus::check_start_test
