#pragma once
/// Division of the tiles of a run among processes, by Zoltan (Boman et al. 2012, Sci. Program. 20:129).

#include <mpi.h>
#include <zoltan.h>

#include <memory>
#include <vector>

namespace talus {

/// The occupied tiles of a run.
struct TilesOfRun {
  int dim;
  const std::vector<int>* places;  ///< `dim` numbers each
  const std::vector<long>* work;
};

/// Cuts space in parts of equal work, one for each process, by recursive bisection (Zoltan's RCB). The cuts are kept, because
/// tiles that come later belong to the same parts. All processes call the functions in the same order with the same tiles.
/// Parts of RCB have smaller halos than ranges of Hilbert's curve (HSFC): for a cylinder of 5800 tiles by a third on two
/// processes, by a fifth on eight.
class TileDivision {
 public:
  explicit TileDivision(MPI_Comm processes);

  /// Whether there are cuts for tiles of this dimension.
  bool is_cut(int dim) const { return zoltan_ && dim_ == dim; }
  /// Each process describes a stretch of the tiles to Zoltan. Throws std::runtime_error if Zoltan fails.
  void cut(const TilesOfRun& tiles);
  /// The parts of the tiles in the stretch of this process.
  std::vector<double> parts(const TilesOfRun& tiles) const;

 private:
  struct Destroy {
    void operator()(Zoltan_Struct* z) const { Zoltan_Destroy(&z); }
  };

  MPI_Comm processes_;
  std::unique_ptr<Zoltan_Struct, Destroy> zoltan_;
  int dim_ = 0;
};

/// Largest sum of work of an owner over the mean of all.
double imbalance(const std::vector<int>& owners, const std::vector<long>& work, int n_owners);

/// The time that has been lost since tiles were cut because work is less equal than it was then. `work`: of each tile in a step
/// [ns].
class LossOfDivision {
 public:
  /// After a cut.
  void start(const std::vector<int>& owners, const std::vector<long>& work, int n_owners);
  /// Adds what has been lost in `n_steps`. Returns true if all is more than a cut takes, or if the largest work exceeds
  /// `most_imbalance` times the mean.
  bool calls_for_a_cut(const std::vector<int>& owners, const std::vector<long>& work, int n_owners, long n_steps);

 private:
  double at_start_ = 1, lost_ = 0;  ///< lost [ns]
};

}  // namespace talus
