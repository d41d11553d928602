/// Values that are possible, but so unusual that talus asks.

#include "talus/mpm/start/plausibility.hpp"

#include <gtest/gtest.h>

#include <filesystem>

#include "talus/input/read.hpp"

namespace talus::plausibility_test {

const std::string cases = TALUS_SOURCE_DIR "/cases/";

std::vector<std::string> doubts(const std::string& name, const std::vector<std::string>& set = {}) {
  return doubts_about(read_case(cases + name + ".toml", read_overrides(set)).case_);
}

TEST(Plausibility, NoShippedCaseIsDoubtful) {
  for (const auto& entry : std::filesystem::directory_iterator(cases))
    if (entry.path().extension() == ".toml" && entry.path().stem().string().find("wide") == std::string::npos) {
      const std::vector<std::string> all = doubts(entry.path().stem().string());
      EXPECT_TRUE(all.empty()) << entry.path() << ": " << all.front();
    }
}

TEST(Plausibility, UnusualValuesAreNamedWithTheUsualRange) {
  const auto only = [](const std::string& name, const std::string& assignment) {
    const std::vector<std::string> all = doubts(name, {assignment});
    EXPECT_EQ(all.size(), 1u) << assignment;
    return all.empty() ? "" : all.front();
  };
  EXPECT_EQ(only("free_fall", "material.sand.density=1.6 kg/m3"),
            "material.sand.density = 1.6 kg/m3 is unusual; usual values are between 100 kg/m3 and 10000 kg/m3.");
  EXPECT_EQ(only("slump_2d", "material.glass.rho_s=2.5 kg/m3").rfind("material.glass.rho_s = 2.5 kg/m3 is unusual", 0),
            0u);
  EXPECT_EQ(only("slope", "domain.walls.y_min.friction=99"),
            "domain.walls.y_min.friction = 99 is unusual; usual values are between 0 and 2.");
  EXPECT_EQ(only("free_fall", "domain.gravity=[\"0 m/s2\", \"0 m/s2\", \"9.81 m/s2\"]")
                .rfind("domain.gravity points upwards: its component along z is 9.81 m/s2.", 0),
            0u);
}

TEST(Plausibility, AReleaseIsNoThinnerThanHalfAParticle) {
  // Particles stand 2.5 m apart, and half of that is 1.25 m. The thickness is that of the release, although pixels on its
  // outline are covered in part.
  const std::string release =
      "body.slide.release={ polygons = \"landslide/release.geojson\", measured = \"vertical\", thickness = \"";
  const std::vector<std::string> all = doubts("landslide", {release + "1 m\" }"});
  ASSERT_EQ(all.size(), 1u);
  EXPECT_NE(all[0].find("is 1 m thick on average (vertical), less than half the `spacing` of its particles, 2.5 m"),
            std::string::npos)
      << all[0];
  EXPECT_TRUE(doubts("landslide", {release + "1.25 m\" }"}).empty());
}

TEST(Plausibility, GroundAtRestNeedsSomethingBelowIt) {
  const std::string box = "body.column.box={ min = [\"-40 mm\", \"10 mm\"], max = [\"40 mm\", \"60 mm\"] }";
  const std::vector<std::string> floating = doubts("slump_2d", {box});
  ASSERT_EQ(floating.size(), 1u);
  EXPECT_NE(floating[0].find("body.column.initial_stress = \"k0\""), std::string::npos) << floating[0];
  // A solid below carries it; a falling body has no doubt either.
  EXPECT_TRUE(doubts("slump_2d",
                     {box,
                      "solid.table={ contact = \"slip\", box = { min = [\"-40 mm\", \"2 mm\"], max = [\"40 mm\", \"10 "
                      "mm\"] } }"})
                  .empty());
  EXPECT_TRUE(doubts("slump_2d", {box, "body.column.initial_stress=zero"}).empty());
}

}  // namespace talus::plausibility_test
