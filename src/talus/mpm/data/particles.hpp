#pragma once
/// The material points of one body.

#include <array>
#include <bit>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "talus/base/columns.hpp"
#include "talus/law/law.hpp"
#include "talus/math/lanes.hpp"
#include "talus/mpm/data/domain.hpp"

namespace talus {

/// Settings that determine the numbers stored per particle: the size of the state of its law, and choices of the
/// solver.
struct ParticleMemory {
  int n_state = 0;
  bool moment = false;    ///< transfer `apic`
  bool gradient = false;  ///< transfer `tpic`
  bool modulus = false;   ///< order `musl`, or tiles at rest that are left out
  int loads = 0;          ///< number of loads on sides of the body
  bool extent = false;    ///< of particles that are split and merged
};

enum class ParticleField {
  position,
  velocity,
  mass,
  reference_volume,
  ids,
  state,
  velocity_moment,
  velocity_gradient,
  loaded_area,
  wave_modulus,
  extent
};

/// List of all fields of a particle, in the order of `ParticleField`. Storage, sorting, migration, restart,
/// output and estimates of memory follow from it.
struct ParticleFieldInfo {
  std::string_view name, meaning;
  int (*components)(int dim, const ParticleMemory&);
};
inline constexpr ParticleFieldInfo particle_fields[] = {
    {"position", "[m]", [](int dim, const ParticleMemory&) { return dim; }},
    {"velocity", "[m/s]", [](int dim, const ParticleMemory&) { return dim; }},
    {"mass", "[kg], in plane strain per metre of thickness, axisymmetric per radian",
     [](int, const ParticleMemory&) { return 1; }},
    {"reference_volume", "[m3] at specific volume 1: the volume of the grains, or that at the start",
     [](int, const ParticleMemory&) { return 1; }},
    {"ids", "`ParticleIds` in the bits of a number", [](int, const ParticleMemory&) { return 1; }},
    {"state", "what the law remembers", [](int, const ParticleMemory& m) { return m.n_state; }},
    {"velocity_moment", "sum N_I v_I (x_I - x)^T [m2/s], row by row",
     [](int dim, const ParticleMemory& m) { return m.moment ? dim * dim : 0; }},
    {"velocity_gradient", "[1/s], row by row",
     [](int dim, const ParticleMemory& m) { return m.gradient ? dim * dim : 0; }},
    {"loaded_area", "[m2] of each loaded side, at the start", [](int, const ParticleMemory& m) { return m.loads; }},
    {"wave_modulus", "volume times K + 4/3 G [J]", [](int, const ParticleMemory& m) { return m.modulus ? 1 : 0; }},
    {"extent", "squared edges of the material it stands for [m2]: xx, yy(, zz), xy(, yz, zx), two floats in a number",
     [](int dim, const ParticleMemory& m) { return m.extent ? (dim * (dim + 1) / 2 + 1) / 2 : 0; }},
};
inline constexpr int n_particle_fields = std::size(particle_fields);

/// First column of each field, and number of columns.
struct ParticleLayout {
  std::array<int, n_particle_fields + 1> first{};

  ParticleLayout(int dim, const ParticleMemory& memory) {
    for (int f = 0; f < n_particle_fields; ++f) first[f + 1] = first[f] + particle_fields[f].components(dim, memory);
  }
  TALUS_HD int begin(ParticleField f) const { return first[int(f)]; }
  TALUS_HD int components(ParticleField f) const { return first[int(f) + 1] - first[int(f)]; }
  int n_columns() const { return first.back(); }
};

/// What tells a particle: `id` in the order of creation from 0 on, `ancestor` the id of the particle of the start that it, or
/// the larger part of it, was split from.
struct ParticleIds {
  static constexpr long most = std::numeric_limits<std::uint32_t>::max();
  std::uint32_t id, ancestor;
};

/// Positions of four particles, one pack for each axis.
template <int Dim>
using FourPlaces = std::array<Quad, Dim>;

/// Particles of a body as a view for kernels: pointers to columns, whose rows are ordered by tile and within a tile by
/// cell.
template <int Dim>
struct ParticlesView {
  double* const* columns;
  ParticleLayout layout;

  TALUS_HD double* column(ParticleField f, int component = 0) const { return columns[layout.begin(f) + component]; }
  TALUS_HD double* position(int axis) const { return column(ParticleField::position, axis); }
  TALUS_HD double* velocity(int axis) const { return column(ParticleField::velocity, axis); }
  TALUS_HD double* mass() const { return column(ParticleField::mass); }
  TALUS_HD double* reference_volume() const { return column(ParticleField::reference_volume); }
  TALUS_HD ParticleIds ids(int i) const { return std::bit_cast<ParticleIds>(column(ParticleField::ids)[i]); }
  TALUS_HD double* state(int number) const { return states()[number]; }
  TALUS_HD double* const* states() const { return columns + layout.begin(ParticleField::state); }
  /// Component a of the variation of velocity along axis b around the particle: its moment or gradient, depending on
  /// the transfer.
  TALUS_HD double* affine(int a, int b) const { return column(ParticleField::velocity_moment, Dim * a + b); }
  /// Area of the loaded side that the particle represents, for each load of the body.
  TALUS_HD double* loaded_area(int load) const { return column(ParticleField::loaded_area, load); }
  TALUS_HD double* wave_modulus() const { return column(ParticleField::wave_modulus); }
  TALUS_HD double* extent(int pair) const { return column(ParticleField::extent, pair); }

  /// Has the fields from `begin` to `end` of eight particles from `first` on brought into the cache, while something else is computed.
  TALUS_HD void fetch(ParticleField begin, ParticleField end, int first) const {
    for (int c = layout.begin(begin); c < layout.begin(end); ++c) fetch_ahead(columns[c] + first);
  }

  /// Positions of `count` particles from `first` on, at most as many as R holds [m], one pack for each axis.
  template <class R = Quad>
  TALUS_HD std::array<R, Dim> places(int first, int count) const {
    std::array<R, Dim> x;
    for (int a = 0; a < Dim; ++a) x[a] = load<R>(position(a) + first, count);
    return x;
  }
};

/// Owns the columns.
template <int Dim>
class Particles {
 public:
  explicit Particles(const ParticleMemory& memory)
      : memory_(memory), layout_(Dim, memory), columns_(layout_.n_columns()) {}

  int size() const { return columns_.size(); }
  /// Throws std::length_error if there are more than a row number holds.
  void resize(std::size_t n) {
    constexpr int most = std::numeric_limits<int>::max();
    if (n > std::size_t(most))
      throw std::length_error("a body has " + std::to_string(n) + " particles in one process, which may have " +
                              std::to_string(most) + ": start more processes, or divide the body into several");
    columns_.resize(int(n));
  }
  const ParticleMemory& memory() const { return memory_; }
  const ParticleLayout& layout() const { return layout_; }
  Columns& columns() { return columns_; }
  const Columns& columns() const { return columns_; }

  ParticlesView<Dim> view() { return {columns_.pointers(), layout_}; }
  /// For reading.
  ParticlesView<Dim> view() const { return {columns_.pointers(), layout_}; }

  double* position(int axis) { return view().position(axis); }
  const double* position(int axis) const { return view().position(axis); }
  double* velocity(int axis) { return view().velocity(axis); }
  const double* velocity(int axis) const { return view().velocity(axis); }
  double* mass() { return view().mass(); }
  const double* mass() const { return view().mass(); }
  double* reference_volume() { return view().reference_volume(); }
  const double* reference_volume() const { return view().reference_volume(); }
  long id(int i) const { return view().ids(i).id; }
  long ancestor(int i) const { return view().ids(i).ancestor; }
  /// Throws std::length_error if one is larger than `ParticleIds::most`.
  void set_ids(int i, long id, long ancestor) {
    if (id > ParticleIds::most || ancestor > ParticleIds::most)
      throw std::length_error("a run has more than " + std::to_string(ParticleIds::most) + " particles");
    view().column(ParticleField::ids)[i] =
        std::bit_cast<double>(ParticleIds{std::uint32_t(id), std::uint32_t(ancestor)});
  }
  /// Of a particle of the start.
  void set_id(int i, long id) { set_ids(i, id, id); }
  double* state(int number) { return view().state(number); }
  const double* state(int number) const { return view().state(number); }
  double* affine(int a, int b) { return view().affine(a, b); }
  const double* affine(int a, int b) const { return view().affine(a, b); }
  double* loaded_area(int load) { return view().loaded_area(load); }
  const double* loaded_area(int load) const { return view().loaded_area(load); }
  double* wave_modulus() { return view().wave_modulus(); }
  const double* wave_modulus() const { return view().wave_modulus(); }
  double* extent(int pair) { return view().extent(pair); }
  const double* extent(int pair) const { return view().extent(pair); }

 private:
  ParticleMemory memory_;
  ParticleLayout layout_;
  Columns columns_;
};

/// The state of `count` particles from `first` on, at most as many as R holds.
template <Number R, class State, int Dim>
TALUS_HD State load_states(const ParticlesView<Dim>& particles, int first, int count) {
  State state;
  double* const* const from = particles.states();
  constexpr std::size_t n = sizeof(State) / sizeof(R);
  if (count >= width_of<R>)
    for_constants<n>([&](auto k) { numbers_of<R>(state)[k] = load<R>(from[k] + first); });
  else
    for_constants<n>([&](auto k) { numbers_of<R>(state)[k] = load<R>(from[k] + first, count); });
  return state;
}
template <Number R, class State, int Dim>
TALUS_HD void store_states(const ParticlesView<Dim>& particles, int first, int count, const State& state) {
  double* const* const to = particles.states();
  constexpr std::size_t n = sizeof(State) / sizeof(R);
  if (count >= width_of<R>)
    for_constants<n>([&](auto k) { store(to[k] + first, numbers_of<R>(state)[k]); });
  else
    for_constants<n>([&](auto k) { store(to[k] + first, numbers_of<R>(state)[k], count); });
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

/// Rows [begin, end) of a table of particles, as those of a tile.
struct RowRange {
  int begin = 0, end = 0;
  TALUS_HD int size() const { return end - begin; }
};

}  // namespace talus
