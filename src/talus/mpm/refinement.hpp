#pragma once
/// Particles that stand for stretched material are split; alike ones in crowded cells are merged.
///
/// A particle remembers the material it stands for as the squared edges S of a box, which goes with the flow: S+ = F S F^T.
/// Where the longest edge L exceeds a cell, and along it, on one side, empty cells are followed by particles, on the other
/// side are particles too, connected material has lost its particles: the particle becomes two with half of everything, L/4 to both sides
/// along that edge, and L becomes L/2. So mass, volume, energy, momentum and the centre stay, and second moments too. Flow
/// that shears on and on stretches S as well, but its particles mix: no cell is empty, and nothing is split.
///
/// What one particle becomes depends on the particles of cells around it only, so bits do not depend on threads or owners.

#include <functional>
#include <vector>

#include "talus/mpm/data/body.hpp"
#include "talus/mpm/data/grid.hpp"

namespace talus {

/// How many particles stand in each cell of the occupied tiles; those beside their tile count as in its nearest cell.
template <int Dim>
using CellCounts = TileArray<double, power(tile_edge, Dim)>;

/// A particle to be split: itself goes to x + offset, a new one to x - offset.
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
void add_counts(const Body<Dim>& body, TileParticles range, const Domain<Dim>& domain, const Tile<Dim>& tile,
                double* counts);

/// How many particles of a body a cell may hold before alike ones are merged: four times what fills it at the start, and at
/// least four along each axis.
template <int Dim>
double most_in_cell_of(double spacing, double h);

/// S of a particle [m2]; in 2D zz, yz and zx are 0.
template <int Dim>
SymTensor<double> extent_of(const Particles<Dim>& p, int i);
template <int Dim>
void set_extent(Particles<Dim>& p, int i, const SymTensor<double>& S);

/// Material that moved with the velocity gradient L [1/s] for a time [s]. What is longer than `longest` [m] has long been
/// mixed with other material: it keeps its shape only.
SymTensor<double> stretched(const SymTensor<double>& S, const Tensor<double>& L, double time, double longest);

/// Particles of a body in a tile that have to be split. `along(x, offset)` returns what solids and walls leave of an
/// offset, to both sides.
template <int Dim>
std::vector<Split> find_splits(const Body<Dim>& body, TileParticles range, const Domain<Dim>& domain,
                               const Tile<Dim>* tiles, int t, const CellCounts<Dim>& counts,
                               const std::function<Vec<3>(const Vec<3>& x, Vec<3> offset)>& along);

/// Pairs that have to be merged where a cell of the tile holds more than so many; none of them is split.
template <int Dim>
std::vector<Merger> find_mergers(const Body<Dim>& body, TileParticles range, const Domain<Dim>& domain,
                                 const Tile<Dim>& tile, double most_in_cell, const std::vector<Split>& splits);

/// Gives the particles that are split half of what they had, and their new places.
template <int Dim>
void apply_splits(Body<Dim>& body, const std::vector<Split>& splits);
/// Puts the second of each pair into the first. Returns the elastic energy that this takes [J].
template <int Dim>
double apply_mergers(Body<Dim>& body, const std::vector<Merger>& mergers);

}  // namespace talus
