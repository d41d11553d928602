#pragma once
/// Splitting of stretched particles, and merging of similar ones in crowded cells.
///
/// A particle has the squared edges S of the box of its material, which deforms with the flow: S+ = F S F^T. If its
/// largest width L across its motion exceeds a cell, and in that direction on one side empty cells are followed by
/// particles, and on the other side there are particles too, connected material lacks particles: the particle becomes
/// two with half of everything, L/4 to both sides in that direction, and L becomes L/2. Mass, volume, energy, momentum,
/// centre and the second moment in that direction are conserved. Continued shear stretches S as well, but its particles
/// mix: no cell is empty, and nothing is split.
///
/// Along its motion a thin front is drawn out into single particles; as halves they would be connected farther out. So
/// `Splitting::all_directions`, which takes the longest edge of S for L, moves fronts.
///
/// Parts of what was split are joined again where their cell is full, and any alike particles where it is crowded.
///
/// The result for a particle depends only on the particles of cells around it, so it does not depend on threads or
/// owners.

#include <functional>
#include <vector>

#include "talus/case/case.hpp"
#include "talus/mpm/data/body.hpp"
#include "talus/mpm/data/grid.hpp"

namespace talus {

/// Number of particles in each cell of the occupied tiles; those outside their tile belong to its nearest cell.
template <int Dim>
using CellCounts = TileArrayView<double, power(tile_edge, Dim)>;

/// A particle to be split: it moves to x + offset, a new one to x - offset.
struct Split {
  int particle;
  Vec<3> offset;        ///< [m]
  SymTensor<double> S;  ///< of both [m2]
};
/// Two to be merged: the second goes into the first.
struct Merger {
  int first, second;
};

/// Adds a body's particles in a tile to the counts of its cells.
template <int Dim>
void add_counts(const Body<Dim>& body, RowRange range, const Domain<Dim>& domain, const Tile<Dim>& tile,
                double* counts);

/// When particles of a body are merged. `full_cell`: how many fill a cell at the start.
struct MergingRule {
  double full_cell;   ///< more of them, and parts of what was split are joined again
  double most;        ///< more of them, and any alike ones are: four times as many, and at least four along each axis
  double whole_mass;  ///< that parts have together at most [kg]
};
/// `mean_mass`: of the body's particles at the start [kg].
template <int Dim>
MergingRule merging_rule(double spacing, double h, double mean_mass);

/// S of a particle [m2]; in 2D zz, yz and zx are 0.
template <int Dim>
SymTensor<double> extent_of(const Particles<Dim>& p, int i);
template <int Dim>
void set_extent(Particles<Dim>& p, int i, const SymTensor<double>& S);

/// S after motion with the velocity gradient L [1/s] for a time T [s], F = 1 + T L + (T L)^2/2: a rotation by 0.1 keeps
/// the edges to 1e-5. A box longer than `longest` [m] is scaled down to
/// it: its material is mixed with other material.
template <class R>
SymTensor<R> stretched(const SymTensor<R>& S, const Tensor<R>& L, double time, double longest) {
  Tensor<R> F;
  for (int a = 0; a < 3; ++a)
    for (int b = 0; b < 3; ++b) {
      const R LL = L[a][0] * L[0][b] + L[a][1] * L[1][b] + L[a][2] * L[2][b];
      F[a][b] = R(a == b ? 1.0 : 0.0) + R(time) * L[a][b] + R(0.5 * time * time) * LL;
    }
  const SymTensor<R> longer = transformed(F, S);
  return min(R(1.0), R(longest * longest) / trace(longer)) * longer;
}

/// S of the projection of a box on the plane normal to its velocity v [m/s], which is not 0.
SymTensor<double> across(const SymTensor<double>& S, const Vec<3>& v);

/// In which directions particles are split, and how fast at least they move then [m/s].
struct SplittingRule {
  Splitting directions;
  double rest_speed;  ///< of `across_motion`: what rests does not tear
  /// Lighter particles are not split [kg]: in a flow that never ends, as in a drum, single ones above it are drawn out again and
  /// again, and nodes throw what has next to no mass.
  double least_mass;
};
/// Parts that a particle of mean mass is split into at most. A cylinder that spreads needs eight all around.
inline constexpr double most_parts = 64;
/// Particles of a body in a tile that have to be split. `along(x, offset)` returns what solids and walls leave of an
/// offset, to both sides.
template <int Dim>
std::vector<Split> find_splits(const SplittingRule& rule, const Body<Dim>& body, RowRange range,
                               const Domain<Dim>& domain, const Tile<Dim>* tiles, int t, const CellCounts<Dim>& counts,
                               const std::function<Vec<3>(const Vec<3>& x, Vec<3> offset)>& along);

/// Pairs that have to be merged where a cell of the tile holds too many; none of them is split.
template <int Dim>
std::vector<Merger> find_mergers(const MergingRule& rule, const Body<Dim>& body, RowRange range,
                                 const Domain<Dim>& domain, const Tile<Dim>& tile, const std::vector<Split>& splits);

/// Gives the particles that are split half of what they had, and their new places.
template <int Dim>
void apply_splits(Body<Dim>& body, const std::vector<Split>& splits);
/// Merges the second of each pair into the first. Returns the elastic energy lost [J].
template <int Dim>
double apply_mergers(Body<Dim>& body, const std::vector<Merger>& mergers);

}  // namespace talus
