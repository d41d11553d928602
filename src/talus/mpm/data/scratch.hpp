#pragma once
/// Working space of one thread: quantities of the particles of a tile during the stress update.

#include <vector>

#include "talus/math/lanes.hpp"
#include "talus/math/tensor.hpp"

namespace talus {

/// View for kernels: rows with one number per particle of the tile, padded by the widest pack.
struct ScratchView {
  double* gradient[3][3];          ///< velocity gradient L [1/s]
  double* flux[6];                 ///< volume times stress [J], tension-positive
  double* stiffness;               ///< volume times modulus of compression waves [J]
  double *share, *p, *volume;      ///< of the particles: what compression counts in a mean, its pressure, volume
  double *mean_share, *mean_p;     ///< of the particle's cell
  double *mean_per_p, *mean_rate;  ///< of the particle's cell: compression over the mean pressure it causes, tr L
  double* filling;                 ///< of the nodes around the particle, see `shift_four`
  int* cell;                       ///< number of the particle's cell in its tile
  double* velocity[3] = {};        ///< of the nodes, interpolated [m/s]; elsewhere, or null

  /// Of the particle, or particles from i on.
  template <class R = double>
  TALUS_HD Tensor<R> gradient_of(int i) const {
    Tensor<R> L;
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) L[a][b] = load<R>(&gradient[a][b][i]);
    return L;
  }
};

/// Owns the rows, as long as the largest tile.
class Scratch {
 public:
  /// With room for n particles.
  ScratchView view(int n) {
    n += widest_pack;  // the last pack may extend beyond the last particle
    if (n > int(cells_.size())) {
      for (auto& row : rows_) row.assign(std::size_t(n), 0.0);
      cells_.assign(std::size_t(n), 0);
    }
    ScratchView v;
    double* rows[n_rows];
    for (int r = 0; r < n_rows; ++r) rows[r] = rows_[r].data();
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) v.gradient[a][b] = rows[3 * a + b];
    for (int c = 0; c < 6; ++c) v.flux[c] = rows[9 + c];
    v.stiffness = rows[15];
    v.share = rows[16];
    v.p = rows[17];
    v.volume = rows[18];
    v.mean_share = rows[19];
    v.mean_p = rows[20];
    v.mean_per_p = rows[21];
    v.mean_rate = rows[22];
    v.filling = rows[23];
    v.cell = cells_.data();
    return v;
  }

 private:
  static constexpr int n_rows = 24;
  std::vector<double> rows_[n_rows];
  std::vector<int> cells_;
};

}  // namespace talus
