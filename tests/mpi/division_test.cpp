/// Division of tiles among the processes of mpirun, which starts this program.

#include <gtest/gtest.h>
#include <mpi.h>

#include <algorithm>
#include <set>

#include "talus/backend/mpi/tile_division.hpp"

namespace division_test {

int n_processes() {
  int n;
  MPI_Comm_size(MPI_COMM_WORLD, &n);
  return n;
}

struct Load {
  int dim;
  std::vector<int> places;
  std::vector<long> work;

  void add(std::initializer_list<int> place, long w) {
    places.insert(places.end(), place);
    work.push_back(w);
  }
  std::size_t n() const { return work.size(); }
  talus::TilesOfRun tiles() const { return {dim, &places, &work}; }
};

/// The owners of all tiles, from the parts that each process finds.
std::vector<int> owners_of(const talus::TileDivision& division, const Load& load) {
  const std::vector<double> mine = division.parts(load.tiles());
  const int n = int(mine.size());
  std::vector<int> counts(static_cast<std::size_t>(n_processes())), begins(counts.size(), 0);
  MPI_Allgather(&n, 1, MPI_INT, counts.data(), 1, MPI_INT, MPI_COMM_WORLD);
  for (std::size_t o = 1; o < counts.size(); ++o) begins[o] = begins[o - 1] + counts[o - 1];
  std::vector<double> all(load.n());
  MPI_Allgatherv(mine.data(), n, MPI_DOUBLE, all.data(), counts.data(), begins.data(), MPI_DOUBLE, MPI_COMM_WORLD);
  return {all.begin(), all.end()};
}

/// A deposit, 50 x 12 tiles, of which the left fifth takes ten times the work.
Load uneven_plane() {
  Load load{2, {}, {}};
  for (int x = -10; x < 40; ++x)
    for (int y = 0; y < 12; ++y) load.add({x, y}, x < 0 ? 10000 : 1000);
  return load;
}

/// A cylinder, 25 tiles across and 12 high, whose outermost tiles are partly full.
Load cylinder() {
  Load load{3, {}, {}};
  for (int x = 0; x < 25; ++x)
    for (int y = 0; y < 25; ++y)
      for (int z = 0; z < 12; ++z) {
        const int r2 = (x - 12) * (x - 12) + (y - 12) * (y - 12);
        if (r2 <= 150) load.add({x, y, z}, r2 > 120 ? 1000 + 100 * ((x + y + z) % 10) : 5000);
      }
  return load;
}

TEST(TileDivision, IsBalancedToAboutATileWhateverTheLoad) {
  for (const Load& load : {uneven_plane(), cylinder()}) {
    talus::TileDivision division(MPI_COMM_WORLD);
    division.cut(load.tiles());
    const std::vector<int> owners = owners_of(division, load);
    double all = 0;
    for (const long w : load.work) all += double(w);
    // Every bisection leaves one tile too much on one side, and there are three for up to eight processes.
    const double of_tile = double(*std::max_element(load.work.begin(), load.work.end())) * n_processes() / all;
    EXPECT_LT(talus::imbalance(owners, load.work, n_processes()), 1.01 + 3 * of_tile);
    EXPECT_LT(talus::imbalance(owners, load.work, n_processes()), 1.1)
        << "more, and tiles would be divided at once again";
    EXPECT_EQ(std::set<int>(owners.begin(), owners.end()).size(), std::size_t(n_processes()));
  }
}

TEST(TileDivision, IsTheSameForTheSameLoadAndForTilesOnBothSidesOfTheCuts) {
  const Load load = cylinder();
  talus::TileDivision one(MPI_COMM_WORLD), other(MPI_COMM_WORLD);
  one.cut(load.tiles());
  other.cut(load.tiles());
  const std::vector<int> owners = owners_of(one, load);
  EXPECT_EQ(owners, owners_of(other, load));
  // The same tiles, described by other processes, and new ones around them.
  Load later{3, {}, {}};
  std::vector<int> expected;
  for (std::size_t t = load.n(); t-- > 0;) {
    later.add({load.places[3 * t], load.places[3 * t + 1], load.places[3 * t + 2]}, 1);
    expected.push_back(owners[t]);
  }
  later.add({-5, 12, 0}, 1);
  later.add({60, 12, 6}, 1);
  std::vector<int> found = owners_of(one, later);
  for (std::size_t t = expected.size(); t < found.size(); ++t) EXPECT_TRUE(found[t] >= 0 && found[t] < n_processes());
  found.resize(expected.size());
  EXPECT_EQ(found, expected);
}

TEST(TileDivision, PartsNeedNotBeBricks) {
  // 7 x 7 equal tiles have no plane that halves them.
  Load load{2, {}, {}};
  for (int x = 0; x < 7; ++x)
    for (int y = 0; y < 7; ++y) load.add({x, y}, 1);
  talus::TileDivision division(MPI_COMM_WORLD);
  division.cut(load.tiles());
  const std::vector<int> owners = owners_of(division, load);
  std::vector<int> n(std::size_t(n_processes()), 0);
  for (const int o : owners) ++n[std::size_t(o)];
  const auto [least, most] = std::minmax_element(n.begin(), n.end());
  EXPECT_LE(*most - *least, n_processes() <= 3 ? 1 : 3);
}

TEST(TileDivision, WorksWithFewerTilesThanProcessesAndInARow) {
  Load one{2, {}, {}}, row{3, {}, {}};
  one.add({5, -3}, 100);
  for (int z = 0; z < 40; ++z) row.add({7, 7, z}, 100);
  talus::TileDivision division(MPI_COMM_WORLD);
  EXPECT_FALSE(division.is_cut(2));
  division.cut(one.tiles());
  EXPECT_TRUE(division.is_cut(2));
  const std::vector<int> owner = owners_of(division, one);
  EXPECT_TRUE(owner[0] >= 0 && owner[0] < n_processes());
  division.cut(row.tiles());
  EXPECT_FALSE(division.is_cut(2));
  EXPECT_LE(talus::imbalance(owners_of(division, row), row.work, n_processes()), 1.3) << "tiles are a fifth of a share";
}

TEST(LossOfDivision, CallsForACutOnceItHasCostMoreThanACut) {
  // Two owners have 50 tiles of 1 ms each: 50 ms a step. A cut takes 100 x 4 us and a step, 50.4 ms.
  std::vector<int> owners(100, 0);
  std::fill(owners.begin() + 50, owners.end(), 1);
  std::vector<long> work(100, 1000000);
  talus::LossOfDivision loss;
  loss.start(owners, work, 2);
  EXPECT_FALSE(loss.calls_for_a_cut(owners, work, 2, 1000)) << "nothing is lost";
  for (std::size_t t = 0; t < 50; ++t) work[t] += 40000;  // 52 and 50 ms, 1 more than the mean of 51
  EXPECT_FALSE(loss.calls_for_a_cut(owners, work, 2, 25));
  EXPECT_FALSE(loss.calls_for_a_cut(owners, work, 2, 25)) << "50 ms";
  EXPECT_TRUE(loss.calls_for_a_cut(owners, work, 2, 2)) << "52 ms; the cut takes 51.4";
  loss.start(owners, work, 2);
  EXPECT_FALSE(loss.calls_for_a_cut(owners, work, 2, 1000)) << "tiles could not be divided more equally";
  for (std::size_t t = 0; t < 50; ++t) work[t] += 300000;
  EXPECT_TRUE(loss.calls_for_a_cut(owners, work, 2, 0)) << "more than a tenth above the mean";
}

}  // namespace division_test

int main(int argc, char** argv) {
  MPI_Init(&argc, &argv);
  ::testing::InitGoogleTest(&argc, argv);
  const int result = RUN_ALL_TESTS();
  MPI_Finalize();
  return result;
}
