#include "talus/output/snapshot.hpp"

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>
#include <sys/resource.h>

#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include "folder_of_its_own.hpp"

namespace talus::snapshot_test {

namespace fs = std::filesystem;

class Snapshots : public FolderOfItsOwn {};

Observation two_particles() {
  return {0.25,
          7,
          {{"position", "m", "place", 3, {0.1, 0.2, 0.3, 1.1, 1.2, 1.3}},
           {"velocity", "m/s", "velocity", 3, {1, 2, 3, 4, 5, 6}},
           {"stress", "Pa", "stress", 6, {-1, -2, -3, 4, 5, 6, -10, -20, -30, 40, 50, 60}},
           {"p", "Pa", "pressure", 1, {2, 20}},
           {"id", "1", "number", 1, {3, 123'456'789}}}};
}

TEST_F(Snapshots, AnIndependentReaderFindsTheValuesNamesAndUnits) {
  write_snapshot(folder_ / "a.hdf", two_particles(), {"velocity", "stress", "p", "id"});
  std::ofstream(folder_ / "read.py") << R"(
import h5py, sys
f = h5py.File(sys.argv[1])
v = f["VTKHDF"]
assert bytes(v.attrs["Type"]) == b"UnstructuredGrid" and list(v.attrs["Version"]) == [1, 0]
assert v["NumberOfPoints"][0] == 2 and v["NumberOfCells"][0] == 2 and v["NumberOfConnectivityIds"][0] == 2
assert list(v["Offsets"]) == [0, 1, 2] and list(v["Connectivity"]) == [0, 1] and list(v["Types"]) == [1, 1]
assert v["Points"][1].tolist() == [1.1, 1.2, 1.3]
p = v["PointData"]
assert sorted(p) == ["id", "p", "stress", "velocity"]
assert p["velocity"][1].tolist() == [4, 5, 6] and p["velocity"].attrs["units"] == b"m/s"
assert p["stress"][0].tolist() == [-1, -2, -3, 4, 5, 6] and p["stress"].attrs["units"] == b"Pa"
assert p["id"][:].tolist() == [3, 123456789] and p["id"].dtype.kind == "i"
assert p["p"][:].tolist() == [2, 20] and p["p"].attrs["meaning"] == b"pressure"
assert f["talus/time"][0] == 0.25 and f["talus/step"][0] == 7
)";
  const std::string command = "/usr/bin/python3 " + (folder_ / "read.py").string() + " " + (folder_ / "a.hdf").string();
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST_F(Snapshots, ManyParticlesAreReadBackByTalusAndByOthers) {
  constexpr int n = 65536 + 70;  // a chunk, and part of another
  Observation seen{
      0, 0, {{"position", "m", "place", 3, {}}, {"p", "Pa", "pressure", 1, {}}, {"id", "1", "number", 1, {}}}};
  for (int i = 0; i < n; ++i) {
    for (int a = 0; a < 3; ++a) seen.fields[0].values.push_back(0.1 * i + a);
    seen.fields[1].values.push_back(0.1 * i);
    seen.fields[2].values.push_back(4e9 + i);
  }
  write_snapshot(folder_ / "a.hdf", seen, {"p", "id"});
  const Observation read = read_snapshot(folder_ / "a.hdf");
  EXPECT_EQ(read.fields[0].values, seen.fields[0].values);
  EXPECT_EQ(read.find("id")->values, seen.fields[2].values);
  for (int i = 0; i < n; ++i) ASSERT_EQ(read.find("p")->values[std::size_t(i)], float(0.1 * i));
  std::ofstream(folder_ / "read.py") << R"(
import h5py, numpy as np, sys
v = h5py.File(sys.argv[1])["VTKHDF"]
i = np.arange(65606)
assert (v["Points"][:] == (0.1 * i)[:, None] + np.arange(3)).all()
assert (v["PointData/p"][:] == (0.1 * i).astype(np.float32)).all() and (v["PointData/id"][:] == 4000000000 + i).all()
assert v["PointData/p"].compression == "gzip" and v["PointData/p"].id.get_storage_size() < 4 * len(i)
)";
  const std::string command = "/usr/bin/python3 " + (folder_ / "read.py").string() + " " + (folder_ / "a.hdf").string();
  EXPECT_EQ(std::system(command.c_str()), 0);
}

TEST_F(Snapshots, WhatWasWrittenIsReadBack) {
  Observation seen = two_particles();
  seen.fields[3].unit = "";  // a text without letters
  write_snapshot(folder_ / "a.hdf", seen, {"velocity", "stress", "p", "id"});
  const Observation read = read_snapshot(folder_ / "a.hdf");
  EXPECT_EQ(read.time, 0.25);
  EXPECT_EQ(read.step, 7);
  ASSERT_EQ(read.fields.size(), 5u);
  EXPECT_EQ(read.fields[0].name, "position");
  for (const Field& f : seen.fields) {
    const Field* found = read.find(f.name);
    ASSERT_TRUE(found) << f.name;
    EXPECT_EQ(found->values, f.values) << f.name;  // small whole numbers, and places in double
    EXPECT_EQ(found->components, f.components);
    EXPECT_EQ(found->unit, f.unit);
    EXPECT_EQ(found->meaning, f.meaning);
  }
  std::ofstream(folder_ / "b.hdf") << "no HDF5";
  EXPECT_THROW(read_snapshot(folder_ / "b.hdf"), std::runtime_error);
}

TEST_F(Snapshots, AReaderMayTakeTheFirstOfSeveralParticles) {
  // A chunk of 65 536 and part of another, in which the first 7th particle is the sixth. The last one is number 69 993 = 9999 x 7.
  Observation seen{0, 0, {{"position", "m", "", 3, {}}, {"id", "1", "", 1, {}}}};
  for (int i = 0; i < 70'000; ++i) {
    for (int a = 0; a < 3; ++a) seen.fields[0].values.push_back(3 * i + a);
    seen.fields[1].values.push_back(i);
  }
  write_snapshot(folder_ / "a.hdf", seen, {"id"});
  EXPECT_EQ(particles_in(folder_ / "a.hdf"), 70'000u);
  const Observation read = read_snapshot(folder_ / "a.hdf", 7);
  ASSERT_EQ(read.n_particles(), 10'000);
  for (int i = 0; i < 10'000; ++i) {
    ASSERT_EQ(read.find("id")->values[std::size_t(i)], 7 * i);
    for (int a = 0; a < 3; ++a) ASSERT_EQ(read.fields[0].values[std::size_t(3 * i + a)], 21 * i + a);
  }
}

TEST_F(Snapshots, TheSeriesListsFilesWithTheirTimes) {
  SnapshotSeries series(folder_, {"p"});
  Observation seen = two_particles();
  series.add(seen);
  seen.time = 0.5;
  series.add(seen);
  series.finish();
  EXPECT_TRUE(fs::exists(series.last()));
  std::ifstream file(series.series_file());
  const auto json = nlohmann::json::parse(file);
  EXPECT_EQ(json["file-series-version"], "1.0");
  ASSERT_EQ(json["files"].size(), 2u);
  EXPECT_EQ(json["files"][1]["time"], 0.5);
  EXPECT_TRUE(fs::exists(folder_ / json["files"][1]["name"].get<std::string>()));
  ASSERT_EQ(read_series(series.series_file()).size(), 2u);
  EXPECT_EQ(read_snapshot(read_series(series.series_file())[1]).time, 0.5);
  EXPECT_THROW(read_series(folder_ / "no.series"), std::runtime_error);
}

TEST_F(Snapshots, ASeriesThatGoesOnKeepsItsOwnAndRemovesOnlySnapshotsThatCameAfter) {
  {
    SnapshotSeries series(folder_, {"p"});
    for (int i = 0; i < 3; ++i) series.add(two_particles());
    series.finish();
  }
  for (const char* name : {"particles_0007.hdf.unfinished", "particles_0007_mine.hdf", "mine.hdf"})
    std::ofstream(folder_ / name) << "x";
  SnapshotSeries series(folder_, {"p"}, {0.25, 0.25});
  const auto is_there = [&](const char* name) { return fs::exists(folder_ / name); };
  EXPECT_TRUE(is_there("particles_0000.hdf") && is_there("particles_0001.hdf"));
  EXPECT_TRUE(is_there("particles_0007_mine.hdf") && is_there("mine.hdf"));
  EXPECT_FALSE(is_there("particles_0002.hdf") || is_there("particles_0007.hdf.unfinished"));
  std::ifstream file(series.series_file());
  EXPECT_EQ(nlohmann::json::parse(file)["files"].size(), 2u);
  series.add(two_particles());
  series.finish();
  EXPECT_EQ(series.last().filename(), "particles_0002.hdf");
  EXPECT_EQ(series.size(), 3);
}

TEST_F(Snapshots, AFileThatCannotBeWrittenIsAnErrorAndLeavesNothingBehind) {
  EXPECT_THROW(write_snapshot(folder_ / "no" / "such" / "a.hdf", two_particles(), {"p"}), std::runtime_error);
  EXPECT_TRUE(fs::is_empty(folder_));
}

TEST_F(Snapshots, AFullDiskIsAnErrorAndLeavesNothingBehind) {
  // A limit on the size of files stands for the full disk.
  const auto write = [&] {
    std::signal(SIGXFSZ, SIG_IGN);
    const rlimit limit{4096, 4096};
    ::setrlimit(RLIMIT_FSIZE, &limit);
    try {
      write_snapshot(folder_ / "a.hdf", two_particles(), {"velocity", "stress", "p"});
    } catch (const std::runtime_error& e) {
      std::fprintf(stderr, "%s", e.what());
      std::exit(fs::is_empty(folder_) ? 0 : 1);  // HDF5 tidies up
    }
    std::exit(2);
  };
  EXPECT_EXIT(write(), testing::ExitedWithCode(0), "a.hdf cannot be written: File too large");
}

TEST_F(Snapshots, NoParticlesMakeAnEmptyFileNotACrash) {
  Observation nothing{0, 0, {{"position", "m", "place", 3, {}}, {"p", "Pa", "pressure", 1, {}}}};
  write_snapshot(folder_ / "empty.hdf", nothing, {"p"});
  EXPECT_TRUE(fs::exists(folder_ / "empty.hdf"));
}

}  // namespace talus::snapshot_test
