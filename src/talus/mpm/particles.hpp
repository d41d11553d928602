#pragma once
/// The material points of one body.

#include <array>
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

/// What some choices of the solver make a particle remember besides.
struct ParticleExtras {
  bool moment = false;    ///< transfer `apic`
  bool gradient = false;  ///< transfer `tpic`
  bool modulus = false;   ///< order `musl`
  int loads = 0;          ///< how many act on sides of the body
};

/// The fields of a particle whose law remembers `n_state` numbers. Storage, sorting, restart and output all walk this
/// list.
template <int Dim>
std::vector<ParticleField> particle_fields(int n_state, const ParticleExtras& extras) {
  int first = 0;
  std::vector<ParticleField> fields;
  const auto add = [&](const char* name, int components) {
    if (components == 0) return;
    fields.push_back({name, first, components});
    first += components;
  };
  add("position", Dim);        // [m]
  add("velocity", Dim);        // [m/s]
  add("mass", 1);              // [kg], in plane strain per metre of thickness, axisymmetric per radian
  add("reference_volume", 1);  // [m3] at specific volume 1: the grains' own volume, or that at the start
  add("id", 1);                // number from 0 in the order of creation
  add("state", n_state);       // what the law remembers
  add("velocity_moment", extras.moment ? Dim * Dim : 0);      // sum N_I v_I (x_I - x)^T [m2/s], row by row
  add("velocity_gradient", extras.gradient ? Dim * Dim : 0);  // [1/s], row by row
  add("loaded_area", extras.loads);                           // [m2] of each loaded side, at the start
  add("wave_modulus", extras.modulus ? 1 : 0);                // volume times K + 4/3 G [J]
  return fields;
}

/// The places of four particles, an axis each.
template <int Dim>
using FourPlaces = std::array<Quad, Dim>;

/// Particles as columns, ordered by tile and within a tile by cell.
template <int Dim>
class Particles {
 public:
  explicit Particles(int n_state, const ParticleExtras& extras = {})
      : columns_(n_columns(n_state, extras)), n_state_(n_state), extras_(extras) {}

  int size() const { return columns_.size(); }
  void resize(int n) { columns_.resize(n); }
  int n_state() const { return n_state_; }
  const ParticleExtras& extras() const { return extras_; }

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

  /// Component a of what velocity does along axis b around the particle: its moment or its gradient, whichever is kept.
  double* affine(int a, int b) { return columns_.column(2 * Dim + 3 + n_state_ + Dim * a + b); }
  const double* affine(int a, int b) const { return columns_.column(2 * Dim + 3 + n_state_ + Dim * a + b); }
  /// What the particle stands for of the side that a load of the body acts on.
  double* loaded_area(int load) {
    return columns_.column(columns_.n_columns() - extras_.modulus - extras_.loads + load);
  }
  const double* loaded_area(int load) const {
    return columns_.column(columns_.n_columns() - extras_.modulus - extras_.loads + load);
  }
  /// Only with `extras().modulus`.
  double* wave_modulus() { return columns_.column(columns_.n_columns() - 1); }
  const double* wave_modulus() const { return columns_.column(columns_.n_columns() - 1); }

  Vec<Dim> position_of(int i) const {
    Vec<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = position(a)[i];
    return x;
  }

  /// The places of `count` particles from `first` on, at most four [m]; an axis each.
  FourPlaces<Dim> places(int first, int count) const {
    FourPlaces<Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = load<Quad>(position(a) + first, count);
    return x;
  }

  Columns& columns() { return columns_; }
  const Columns& columns() const { return columns_; }

 private:
  static int n_columns(int n_state, const ParticleExtras& extras) {
    const ParticleField last = particle_fields<Dim>(n_state, extras).back();
    return last.first + last.components;
  }

  Columns columns_;
  int n_state_;
  ParticleExtras extras_;
};

/// The state of `count` particles from `first` on, at most a pack of them.
template <class State, int Dim>
State load_states(const Particles<Dim>& particles, int first, int count) {
  State state;
  for (std::size_t k = 0; k < sizeof(State) / sizeof(Pack); ++k)
    numbers_of<Pack>(state)[k] = load<Pack>(particles.state(int(k)) + first, count);
  return state;
}
template <class State, int Dim>
void store_states(Particles<Dim>& particles, int first, int count, const State& state) {
  for (std::size_t k = 0; k < sizeof(State) / sizeof(Pack); ++k)
    store(particles.state(int(k)) + first, numbers_of<Pack>(state)[k], count);
}

/// The state of one particle.
template <class Law, int Dim>
typename Law::template State<double> state_of(const Particles<Dim>& particles, int i) {
  typename Law::template State<double> state;
  for (int k = 0; k < state_size<Law>; ++k) numbers_of<double>(state)[k] = particles.state(k)[i];
  return state;
}
template <class Law, int Dim>
void set_state(Particles<Dim>& particles, int i, const typename Law::template State<double>& state) {
  for (int k = 0; k < state_size<Law>; ++k) particles.state(k)[i] = numbers_of<double>(state)[k];
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
