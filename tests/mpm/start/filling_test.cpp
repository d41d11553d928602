#include "talus/mpm/start/filling.hpp"

#include <gtest/gtest.h>
#include <png.h>

#include <fstream>
#include <map>
#include <numbers>
#include <set>

#include "folder_of_its_own.hpp"
#include "talus/input/read.hpp"

namespace talus::filling_test {

class FilesOfACase : public FolderOfItsOwn {
 protected:
  void write(const std::string& name, const std::string& text) const { std::ofstream(folder_ / name) << text; }

  /// A grey PNG, its pixels row by row from the top.
  void write_png(const std::string& name, int width, const std::vector<std::uint8_t>& pixels) const {
    png_image image{};
    image.version = PNG_IMAGE_VERSION;
    image.width = png_uint_32(width);
    image.height = png_uint_32(pixels.size() / std::size_t(width));
    image.format = PNG_FORMAT_GRAY;
    ASSERT_TRUE(png_image_write_to_file(&image, (folder_ / name).c_str(), 0, pixels.data(), 0, nullptr));
  }

  /// A case with one elastic body, made as `body` says.
  std::string with_body(const std::string& body, const std::string& more = "") const {
    return R"(title = "t"
[domain]
kind = "plane_strain"
min = ["0 m", "0 m"]
max = ["10 m", "10 m"]
cell = "1 m"
gravity = ["0 m/s2", "-9.81 m/s2"]
[material.rubber]
law = "linear_elastic"
E = "1 MPa"
nu = 0.2
density = "1000 kg/m3"
[body.b]
material = "rubber"
initial_stress = "zero"
)" + body + more +
           "\n[numerics]\ntau = \"10 ms\"\n[run]\nend = \"1 s\"\n";
  }
  Case read(const std::string& text) const { return read_case_text("case.toml", text, folder_.string()).case_; }
  std::string complaint(const std::string& text) const {
    try {
      read(text);
    } catch (const InputError& e) {
      return e.what();
    }
    ADD_FAILURE() << "was accepted:\n" << text;
    return "";
  }
  void expect(const std::string& text, const std::string& part) const {
    const std::string said = complaint(text);
    EXPECT_NE(said.find(part), std::string::npos) << "expected: " << part << "\nsaid:     " << said;
  }
};

TEST_F(FilesOfACase, ListedPointsAreParticlesWithTheirVolumes) {
  write("p.csv", "# two of them\nx,y,volume\n1,2,0.5\n3.5,4,0.25\n");
  const Case c = read(with_body("points = { file = \"p.csv\" }"));
  const Filling f = fill(c, c.bodies[0]);
  EXPECT_EQ(f.points, (std::vector<Vec<3>>{{1, 2, 0}, {3.5, 4, 0}}));
  EXPECT_EQ(f.volumes, (std::vector<double>{0.5, 0.25}));
  EXPECT_EQ(estimated_particles(c), 2);
  write("q.csv", "y,x\n2,1\n");
  const Case d = read(with_body("points = { file = \"q.csv\" }\nspacing = \"0.5 m\""));
  EXPECT_EQ(fill(d, d.bodies[0]).points, (std::vector<Vec<3>>{{1, 2, 0}}));
  EXPECT_EQ(fill(d, d.bodies[0]).volumes, (std::vector<double>{0.25}));
}

TEST_F(FilesOfACase, FaultsInListedPointsAreToldWithFileAndLine) {
  const std::string points = "points = { file = \"p.csv\" }", spaced = points + "\nspacing = \"0.5 m\"";
  expect(with_body(points), "p.csv cannot be read");
  write("p.csv", "");
  expect(with_body(points), "p.csv holds no rows");
  write("p.csv", "1,2\n3,4\n");
  expect(with_body(points), "has no column `x`; its first line must name the columns x,y, and names 1,2");
  write("p.csv", "x,y,radius\n1,2,3\n");
  expect(with_body(spaced), "has a column `radius`, which is none of `x`, `y` or `volume`");
  write("p.csv", "x,y\n1,2\n");
  expect(with_body(points), "has no volumes: add `spacing`");
  write("p.csv", "x,y,volume\n1,2,1\n");
  expect(with_body(spaced), "has volumes: remove `spacing`");
  write("p.csv", "x,y\n1,2\n\n1,nan\n");
  expect(with_body(spaced), "p.csv:4: a value is missing or not finite");
  write("p.csv", "x,y\n1,2\n1\n");
  expect(with_body(spaced), "p.csv:3: 1 cells, but 2 columns");
  write("p.csv", "x,y,volume\n1,2,0\n");
  expect(with_body(points), "p.csv:2: the volume must be greater than 0");
  write("p.csv", "x,y,volume\n1,2,4\n");
  expect(with_body(points), "hold a particle of edge 2 m, larger than the cells");
  write("p.csv", "x,y\n1,12\n");
  expect(with_body(spaced), "lies outside the domain along y");
  write("p.csv", "x,y\n1,2\n");
  expect(with_body(spaced + "\nlattice = \"cells\""), "has no meaning for listed points");
}

TEST_F(FilesOfACase, ScatteredParticlesStandAtRandomNearTheirPlacesInTheBodyAndHaveItsVolume) {
  const std::string box = "box = { min = [\"1 m\", \"2 m\"], max = [\"4 m\", \"5 m\"] }\nspacing = \"0.5 m\"";
  const auto filled = [&](const std::string& more) {
    const Case c = read(with_body(box + more));
    return fill(c, c.bodies[0]);
  };
  const Filling even = filled(""), one = filled("\nscatter = 0.3"), same = filled("\nscatter = 0.3\nseed = 1"),
                other = filled("\nscatter = 0.3\nseed = 2");
  ASSERT_EQ(one.points.size(), even.points.size());
  EXPECT_EQ(one.points, same.points);
  EXPECT_NE(one.points, other.points);
  double furthest = 0, mean = 0, volume = 0;
  for (std::size_t i = 0; i < one.points.size(); ++i) {
    for (int a = 0; a < 2; ++a) {
      const double off = one.points[i][a] - even.points[i][a];
      furthest = std::max(furthest, std::abs(off));
      mean += off / double(2 * one.points.size());
    }
    volume += one.volumes[i];
  }
  EXPECT_LE(furthest, 0.15);
  EXPECT_GT(furthest, 0.14);  // 72 numbers evenly between -0.15 and 0.15 m
  EXPECT_NEAR(mean, 0, 4 * 0.15 / std::sqrt(3. * 72));
  EXPECT_NEAR(volume, 9, 1e-12);

  expect(with_body(box + "\nseed = 3"), "has no meaning without `scatter`");
  expect(with_body(box + "\nscatter = 0.6"), "scatter");
}

TEST_F(FilesOfACase, PartsOneAfterTheOtherAreTheWholeByTheSameBits) {
  const std::string box = "box = { min = [\"1 m\", \"2 m\"], max = [\"4 m\", \"5 m\"] }\nspacing = \"0.5 m\"";
  for (const std::string more : {"", "\nscatter = 0.3", "\nlattice = \"blue_noise\""}) {
    const Case c = read(with_body(box + more));
    const Filling whole = fill(c, c.bodies[0]);
    ASSERT_EQ(whole.n_of_body, 36);
    for (const int n_parts : {2, 5, 50}) {
      Filling joined;
      for (int i = 0; i < n_parts; ++i) {
        const Filling part = fill(c, c.bodies[0], {i, n_parts});
        EXPECT_EQ(part.first, long(joined.points.size()));
        EXPECT_LE(int(part.points.size()), 36 / n_parts + 1);
        EXPECT_EQ(part.n_of_body, 36);
        EXPECT_EQ(part.centre, whole.centre);
        joined.points.insert(joined.points.end(), part.points.begin(), part.points.end());
        joined.volumes.insert(joined.volumes.end(), part.volumes.begin(), part.volumes.end());
      }
      EXPECT_EQ(joined.points, whole.points) << more;
      EXPECT_EQ(joined.volumes, whole.volumes) << more;
    }
    if (more.empty()) {
      EXPECT_EQ(whole.centre, (Vec<3>{2.5, 3.5, 0}));
    }
  }
}

TEST_F(FilesOfACase, BlueNoiseHasNoRowsAndTheMassOfEveryPart) {
  const std::string box = "box = { min = [\"1 m\", \"1 m\"], max = [\"9 m\", \"9 m\"] }\nspacing = \"0.25 m\"";
  const auto filled = [&](const std::string& more) {
    const Case c = read(with_body(box + more));
    return fill(c, c.bodies[0]);
  };
  const std::string blue = "\nlattice = \"blue_noise\"";
  const Filling one = filled(blue), same = filled(blue + "\nseed = 1"), other = filled(blue + "\nseed = 2"),
                scattered = filled("\nscatter = 0.5");
  ASSERT_EQ(one.points.size(), 32u * 32u);
  EXPECT_EQ(one.points, same.points);
  EXPECT_NE(one.points, other.points);
  double volume = 0;
  std::map<std::pair<int, int>, int> cells;  // as wide as those of the grid: sixteen squares of the lattice
  std::set<long> columns;                    // a hundredth of the spacing wide
  for (std::size_t i = 0; i < one.points.size(); ++i) {
    volume += one.volumes[i];
    ++cells[{int(std::floor(one.points[i][0])), int(std::floor(one.points[i][1]))}];
    columns.insert(std::lround(std::floor(one.points[i][0] / 0.0025)));
  }
  EXPECT_NEAR(volume, 64, 1e-10);
  for (const auto& [cell, n] : cells) EXPECT_EQ(n, 16);
  // 1024 points in 3200 columns at random leave 3200 exp(-1024/3200) empty, 2324; a lattice leaves all but 32.
  EXPECT_NEAR(double(columns.size()), 3200 - 2324, 60);
  const auto least_distance = [](const Filling& f) {
    double least = 1e300;
    for (std::size_t i = 0; i < f.points.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Vec<3> d = f.points[i] - f.points[j];
        least = std::min(least, dot(d, d));
      }
    return std::sqrt(least);
  };
  EXPECT_GT(least_distance(one), 4 * least_distance(scattered)) << "none nearly coincide";
  EXPECT_GT(least_distance(one), 0.25 * 0.25);
  expect(with_body(box + blue + "\nscatter = 0.2"), "it has no rows");
}

TEST_F(FilesOfACase, BlueNoiseFillsARoundBodyWithoutLeavingIt) {
  const Case c =
      read(with_body("cylinder = { centre = [\"5 m\", \"5 m\"], radius = \"3 m\" }\nspacing = \"0.25 m\"\n"
                     "lattice = \"blue_noise\""));
  double volume = 0;
  const Filling f = fill(c, c.bodies[0]);
  for (std::size_t i = 0; i < f.points.size(); ++i) {
    EXPECT_LE(std::hypot(f.points[i][0] - 5, f.points[i][1] - 5), 3);
    volume += f.volumes[i];
  }
  EXPECT_NEAR(volume, 9 * std::numbers::pi, 1e-10);
}

TEST_F(FilesOfACase, ABodyOnAPlaneOfSymmetryMayNotTurnNorMayOneAroundAnAxis) {
  const std::string box = "box = { min = [\"0 m\", \"2 m\"], max = [\"1.5 m\", \"5 m\"] }\nspacing = \"0.5 m\"\n";
  std::string cut = with_body(box + "angular_velocity = \"2 rad/s\"");
  EXPECT_EQ(read(cut).bodies[0].angular_velocity, (Vec<3>{0, 0, 2}));
  cut.replace(cut.find("\"0 m\", \"2 m\"], max"), 5, "\"-1 m\"");
  cut.replace(cut.find("[material"), 0, "[domain.walls]\nx_min = \"symmetry\"\n");
  expect(cut, "turns the body through the plane of symmetry across x");
  std::string axis = with_body(box + "angular_velocity = \"2 rad/s\"");
  axis.replace(axis.find("plane_strain"), 12, "axisymmetric");
  axis.replace(axis.find("[material"), 0, "[domain.walls]\nx_min = \"slip\"\n");
  expect(axis, "nothing moves around the axis");
}

TEST_F(FilesOfACase, ScatteredParticlesStayOnTheirSideOfAPlaneOfSymmetry) {
  std::string text =
      with_body("box = { min = [\"-1.5 m\", \"2 m\"], max = [\"1.5 m\", \"5 m\"] }\nspacing = \"1 m\"\nscatter = 0.5");
  text.replace(text.find("[material"), 0, "[domain.walls]\nx_min = \"symmetry\"\n");
  const Case c = read(text);
  const Filling f = fill(c, c.bodies[0]);
  ASSERT_EQ(f.points.size(), 6u);  // three on the plane, three beside it
  for (int i = 0; i < 6; i += 2) EXPECT_EQ(f.points[i][0], 0);
  for (const Vec<3>& x : f.points) EXPECT_GE(x[0], 0);
}

TEST_F(FilesOfACase, TheDarkPixelsOfAPictureAreTheBody) {
  write_png("dune.png", 3, {255, 0, 255, 0, 120, 200});
  const std::string image =
      "image = { file = \"dune.png\", min = [\"1 m\", \"2 m\"], pixel = \"1 m\" }\nspacing = \"0.5 m\"";
  const Case c = read(with_body(image));
  const Filling f = fill(c, c.bodies[0]);
  ASSERT_EQ(f.points.size(), 12u);  // four in each of three pixels
  for (const Vec<3>& x : f.points) EXPECT_TRUE((x[1] < 3 && x[0] < 3) || (x[0] > 2 && x[0] < 3)) << x[0] << " " << x[1];
  for (double v : f.volumes) EXPECT_DOUBLE_EQ(v, 0.25);

  std::string text = with_body(image);
  text.replace(text.find("pixel ="), 7, "threshold = 0.4, pixel =");
  const Case darker = read(text);
  EXPECT_EQ(fill(darker, darker.bodies[0]).points.size(), 8u);
}

TEST_F(FilesOfACase, FaultsInPicturesAreTold) {
  const std::string image =
      "image = { file = \"a.png\", min = [\"1 m\", \"2 m\"], pixel = \"1 m\" }\nspacing = \"0.5 m\"";
  expect(with_body(image), "a.png cannot be read");
  write("a.png", "this is no picture");
  expect(with_body(image), "is no PNG that can be read");
  write_png("a.png", 2, {255, 255});
  expect(with_body(image), "has no pixel darker than 0.5");
  write_png("a.png", 2, {0, 0});
  std::string text = with_body(image);
  text.replace(text.find("pixel ="), 7, "threshold = 2, pixel =");
  expect(text, "must be greater than 0 and less than 1");
  std::string unknown = with_body(image);
  unknown.replace(unknown.find("pixel ="), 7, "pixels =");
  expect(unknown, "did you mean `pixel`");
}

TEST_F(FilesOfACase, AMotionMayStandInAFile) {
  write("m.csv", "time,x,y\n0,0,0\n0.5,0,0.1\n1,0,0.4\n");
  const std::string solid =
      "spacing = \"0.5 m\"\nbox = { min = [\"1 m\", \"1 m\"], max = [\"2 m\", \"2 m\"] }\n[solid.s]\n"
      "sphere = { centre = [\"6 m\", \"5 m\"], radius = \"1 m\" }\ncontact = \"slip\"\n";
  const Case c = read(with_body(solid, "motion = { file = \"m.csv\" }"));
  EXPECT_DOUBLE_EQ(c.solids[0].motion.displacement.at(0.75)[1], 0.25);
  write("m.csv", "time,x\n0,0\n");
  expect(with_body(solid, "motion = { file = \"m.csv\" }"), "has no column `y`");
  write("m.csv", "time,x,y\n0,0,0\n1,0,oops\n");
  expect(with_body(solid, "motion = { file = \"m.csv\" }"), "m.csv:3: a value is missing or not finite");
  write("m.csv", "time,x,y\n1,0,0\n0,0,1\n");
  expect(with_body(solid, "motion = { file = \"m.csv\" }"), "must increase: 0 s follows 1 s");
}

}  // namespace talus::filling_test
