#pragma once
/// The material points of one body.

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "talus/base/columns.hpp"
#include "talus/law/law.hpp"
#include "talus/math/vec.hpp"
#include "talus/mpm/grid.hpp"
#include "talus/mpm/loop.hpp"

namespace talus {

/// A group of columns: what is stored of every particle.
struct ParticleField {
  std::string name;
  int first;
  int components;
};

/// The fields of a particle whose law remembers `n_state` numbers. Storage, sorting, restart and output all walk this
/// list.
template <int Dim>
std::vector<ParticleField> particle_fields(int n_state) {
  return {
      {"position", 0, Dim},                  // [m]
      {"velocity", Dim, Dim},                // [m/s]
      {"mass", 2 * Dim, 1},                  // [kg], in plane strain per metre of thickness
      {"reference_volume", 2 * Dim + 1, 1},  // [m3] at specific volume 1: the grains' own volume, or that at the start
      {"id", 2 * Dim + 2, 1},                // number from 0 in the order of creation
      {"state", 2 * Dim + 3, n_state}};      // what the law remembers
}

/// Particles as columns, ordered by tile and within a tile by cell.
template <int Dim>
class Particles {
 public:
  explicit Particles(int n_state) : columns_(2 * Dim + 3 + n_state), n_state_(n_state) {}

  int size() const { return columns_.size(); }
  void resize(int n) { columns_.resize(n); }
  int n_state() const { return n_state_; }

  double* position(int axis) { return columns_.column(axis); }
  const double* position(int axis) const { return columns_.column(axis); }
  double* velocity(int axis) { return columns_.column(Dim + axis); }
  const double* velocity(int axis) const { return columns_.column(Dim + axis); }
  double* mass() { return columns_.column(2 * Dim); }
  const double* mass() const { return columns_.column(2 * Dim); }
  double* reference_volume() { return columns_.column(2 * Dim + 1); }
  const double* reference_volume() const { return columns_.column(2 * Dim + 1); }
  double* id() { return columns_.column(2 * Dim + 2); }
  const double* id() const { return columns_.column(2 * Dim + 2); }
  double* state(int number) { return columns_.column(2 * Dim + 3 + number); }
  const double* state(int number) const { return columns_.column(2 * Dim + 3 + number); }

  Vec<Dim> position_of(int i) const {
    Vec<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = position(a)[i];
    return x;
  }

  Columns& columns() { return columns_; }
  const Columns& columns() const { return columns_; }

 private:
  Columns columns_;
  int n_state_;
};

/// Copies the state of `count` particles, at most a pack of them, from `first` on; empty lanes repeat the last.
template <class State, int Dim>
State load_states(const Particles<Dim>& particles, int first, int count) {
  constexpr int n = sizeof(State) / sizeof(Pack);
  std::array<Pack, n> numbers;
  for (int k = 0; k < n; ++k) {
    const double* column = particles.state(k) + first;
    if (count == pack_width)
      __builtin_memcpy(&numbers[k], column, sizeof(Pack));
    else
      for (int lane = 0; lane < pack_width; ++lane) numbers[k].set(lane, column[std::min(lane, count - 1)]);
  }
  return std::bit_cast<State>(numbers);
}
template <class State, int Dim>
void store_states(Particles<Dim>& particles, int first, int count, const State& state) {
  constexpr int n = sizeof(State) / sizeof(Pack);
  const auto numbers = std::bit_cast<std::array<Pack, n>>(state);
  for (int k = 0; k < n; ++k) {
    double* column = particles.state(k) + first;
    if (count == pack_width)
      __builtin_memcpy(column, &numbers[k], sizeof(Pack));
    else
      for (int lane = 0; lane < count; ++lane) column[lane] = numbers[k][lane];
  }
}

/// The state of one particle.
template <class Law, int Dim>
typename Law::template State<double> state_of(const Particles<Dim>& particles, int i) {
  std::array<double, state_size<Law>> numbers;
  for (int k = 0; k < state_size<Law>; ++k) numbers[k] = particles.state(k)[i];
  return std::bit_cast<typename Law::template State<double>>(numbers);
}
template <class Law, int Dim>
void set_state(Particles<Dim>& particles, int i, const typename Law::template State<double>& state) {
  const auto numbers = std::bit_cast<std::array<double, state_size<Law>>>(state);
  for (int k = 0; k < state_size<Law>; ++k) particles.state(k)[i] = numbers[k];
}

/// The particles of one tile are those numbered [begin, end).
struct TileParticles {
  int begin = 0, end = 0;
  int size() const { return end - begin; }
};

/// The cell a coordinate lies in, and the tile that holds a cell.
inline int cell_of(double x_in_cells) { return int(std::floor(x_in_cells)); }
inline int tile_of(int cell) { return cell >= 0 ? cell / tile_edge : -((-cell + tile_edge - 1) / tile_edge); }

}  // namespace talus
