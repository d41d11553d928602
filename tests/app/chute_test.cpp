/// A laboratory chute of triangles: as a solid and as terrain it guides the same flow.

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <numbers>

#include "app/program.hpp"
#include "folder_of_its_own.hpp"
#include "input/stl_files.hpp"
#include "talus/base/table.hpp"

namespace chute_test {

using program::Finished, program::talus;
using ::talus::Vec;

/// A shallow channel [m], 40 degrees steep, that an arc turns to the level of a floor; radius of its section 1.1 m on the
/// slope. After Gray, Wieland and Hutter 1999 (Proc. R. Soc. A 455:1841), of a third of its size.
double height(double x, double y) {
  constexpr double slope = 40 * std::numbers::pi / 180, radius = 0.5, floor_at = 0.85;
  const double arc = radius * std::sin(slope), before = floor_at - x;  // distance to the floor
  const double z = before <= 0    ? 0
                   : before < arc ? radius - std::sqrt(radius * radius - before * before)
                                  : radius * (1 - std::cos(slope)) + (before - arc) * std::tan(slope);
  const double channel = std::clamp(before / arc, 0.0, 1.0);
  return z + channel * channel * (3 - 2 * channel) * y * y / 2.2;
}

/// The chute as a closed body with a level lower side.
std::string chute() {
  constexpr double from = -0.05, to = 1.45, half = 0.3, bottom = -0.2, edge = 0.03;
  const int nx = int(std::lround((to - from) / edge)), ny = int(std::lround(2 * half / edge));
  std::vector<Vec<3>> corners;
  const auto at = [&](int i, int j, bool upper) {
    const double x = from + edge * i, y = -half + edge * j;
    return Vec<3>{x, y, upper ? height(x, y) : bottom};
  };
  const auto add = [&](const Vec<3>& a, const Vec<3>& b, const Vec<3>& c, const Vec<3>& d) {
    corners.insert(corners.end(), {a, b, c, a, c, d});
  };
  for (int i = 0; i < nx; ++i)
    for (int j = 0; j < ny; ++j) {
      add(at(i, j, true), at(i + 1, j, true), at(i + 1, j + 1, true), at(i, j + 1, true));
      add(at(i, j, false), at(i, j + 1, false), at(i + 1, j + 1, false), at(i + 1, j, false));
    }
  for (int i = 0; i < nx; ++i) {
    add(at(i, 0, false), at(i + 1, 0, false), at(i + 1, 0, true), at(i, 0, true));
    add(at(i + 1, ny, false), at(i, ny, false), at(i, ny, true), at(i + 1, ny, true));
  }
  for (int j = 0; j < ny; ++j) {
    add(at(0, j + 1, false), at(0, j, false), at(0, j, true), at(0, j + 1, true));
    add(at(nx, j, false), at(nx, j + 1, false), at(nx, j + 1, true), at(nx, j, true));
  }
  return ::talus::binary_stl(corners);
}

/// A block of sand on the slope, which runs out on the floor.
const char* const sand = R"(
[material.sand]
law = "mohr_coulomb"
density = "1500 kg/m3"
E = "0.3 MPa"
nu = 0.3
c = "0 Pa"
phi = "35 deg"
psi = "0 deg"

[body.block]
material = "sand"
spacing = "12.5 mm"
box = { min = ["0.06 m", "-0.0625 m", "0.5175 m"], max = ["0.185 m", "0.0625 m", "0.605 m"] }
initial_stress = "zero"

[run]
end = "1 s"

[output]
snapshots = "1 s"
history = "10 ms"
)";

/// Numbers of history.csv by column.
struct History {
  ::talus::NumberTable table;
  std::vector<double> column(const std::string& name) const {
    const auto at = std::ranges::find_if(table.names, [&](const auto& n) { return n.substr(0, n.find(" [")) == name; });
    std::vector<double> values;
    EXPECT_NE(at, table.names.end()) << name;
    if (at != table.names.end())
      for (const auto& row : table.rows) values.push_back(row[std::size_t(at - table.names.begin())]);
    return values;
  }
  double largest(const std::string& name) const { return std::ranges::max(column(name)); }
  double last(const std::string& name) const { return column(name).back(); }
};

class AChute : public ::talus::FolderOfItsOwn {
 protected:
  History run(const std::string& name, const std::string& ground) const {
    std::ofstream(folder_ / "chute.stl", std::ios::binary) << chute();
    std::ofstream(folder_ / (name + ".toml")) << "title = \"chute\"\n" << ground << sand;
    const Finished done = talus("run " + (folder_ / (name + ".toml")).string() + " --out " + (folder_ / name).string());
    EXPECT_EQ(done.code, 0) << done.output;
    return {::talus::read_csv((folder_ / name / "history.csv").string())};
  }
};

TEST_F(AChute, GuidesTheSameFlowAsASolidAndAsTerrain) {
  const std::string domain = R"([domain]
kind = "3d"
cell = "25 mm"
gravity = ["0 m/s2", "0 m/s2", "-9.81 m/s2"]
)";
  const std::string contact = "contact = { kind = \"friction\", friction = 0.4 }\n";
  const History terrain = run("terrain", domain + "[terrain]\nsurface = \"chute.stl\"\nunit = \"m\"\n" + contact),
                solid = run("solid", domain + R"(min = ["-0.05 m", "-0.3 m", "-0.05 m"]
max = ["1.45 m", "0.3 m", "0.9 m"]
[domain.walls]
x_min = "outflow"
x_max = "outflow"
y_min = "outflow"
y_max = "outflow"
z_min = "outflow"
z_max = "outflow"
[solid.chute]
mesh = { file = "chute.stl", unit = "m" }
)" + contact);
  // Both take the plane of contact to half a cell, so the flows differ by some per cent. The block falls by half a metre
  // and slides nearly as far as the chute is long.
  const auto path = [](const History& h) {
    const std::vector<double> time = h.column("time"), momentum = h.column("momentum_x"), mass = h.column("mass");
    double way = 0;
    for (std::size_t i = 1; i < time.size(); ++i)
      way += 0.5 * (momentum[i] / mass[i] + momentum[i - 1] / mass[i - 1]) * (time[i] - time[i - 1]);
    return way;
  };
  EXPECT_GT(path(terrain), 0.6);
  EXPECT_NEAR(path(solid) / path(terrain), 1, 0.03);
  EXPECT_NEAR(solid.largest("kinetic_energy") / terrain.largest("kinetic_energy"), 1, 0.03);
  EXPECT_NEAR(solid.last("wall_friction") / terrain.last("wall_friction"), 1, 0.03);
}

}  // namespace chute_test
