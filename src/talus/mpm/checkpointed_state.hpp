#pragma once
/// What decides the bits of the steps to come, as named arrays: handed out and taken back, whatever the number of threads
/// and owners.

#include <fmt/format.h>

#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "talus/base/image.hpp"
#include "talus/mpm/arrangement.hpp"
#include "talus/mpm/ledger.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus {

/// What a step takes from those before, beside particles, their arrangement, ledger and tally. New members that outlive a
/// step belong here.
struct Carried {
  double drift = 0;       ///< bound on how far any particle has moved since it was put in order, in cells
  double wave_speed = 0;  ///< [m/s]
  double viscosity = 0;   ///< [m2/s]
  double last_dt = std::numeric_limits<double>::infinity();  ///< [s]
  double unfiltered = 0;                                     ///< time since velocities were last filtered [s]
  double unstretched = 0;                                    ///< time since extents went with the flow [s]
  double n_rearranged = 0;                                   ///< how often particles were put in order
  double n_ids = 0;                                          ///< that particles have been given
};

/// The first particle of a body in each tile of the run.
template <int Dim, class Shape>
std::vector<double> first_particles(const Model<Dim, Shape>& m, const Body<Dim>& body) {
  Message mine{double(body.particles.size())};
  for (std::size_t t = 0; t < body.tiles.size(); ++t)
    if (m.grid.tile(int(t)).owned) mine.push_back(body.tiles[t].begin);
  std::vector<double> all;
  double before = 0;
  for (const Message& begins : m.backend.gather(mine)) {
    for (std::size_t i = 1; i < begins.size(); ++i) all.push_back(before + begins[i]);
    before += begins[0];
  }
  return all;
}

template <int Dim, class Shape>
void save(const Model<Dim, Shape>& m, const Ledger& ledger, const StepTally& tally, const Carried& carried,
          const WriteArray& write) {
  write("ledger", image_of(ledger));
  write("tally", image_of(tally));
  write("carried", image_of(carried));
  Message tiles;  // place, first and last cell of every occupied one
  for (int t = 0; t < m.grid.n_occupied(); ++t)
    if (m.grid.tile(t).owned)
      for (const Index<Dim>& corner : {m.grid.tile(t).place, m.grid.cells()[t].low, m.grid.cells()[t].high})
        tiles.insert(tiles.end(), corner.begin(), corner.end());
  write("tiles", joined(m.backend.gather_at_first(tiles)));
  std::vector<double> closed;  // tile, node and surface of every closed contact, and whether it sticks
  for (const ClosedContact<Dim>& c : closed_contacts(m))
    closed.insert(closed.end(), {double(c.tile_number), double(c.node), double(c.surface), double(c.sticks)});
  write("closed contacts", closed);
  for (std::size_t b = 0; b < m.bodies.size(); ++b) {
    write(fmt::format("body {}: first particles of tiles", b), first_particles<Dim, Shape>(m, m.bodies[b]));
    const Columns& columns = m.bodies[b].particles.columns();
    const ParticleLayout& layout = m.bodies[b].particles.layout();
    for (int f = 0; f < n_particle_fields; ++f)
      for (int k = 0; k < layout.components(ParticleField(f)); ++k) {
        const double* column = columns.column(layout.begin(ParticleField(f)) + k);
        const std::string name = fmt::format("body {}: {} {}", b, particle_fields[f].name, k);
        if (m.backend.n_owners() == 1)
          write(name, {column, std::size_t(columns.size())});
        else
          write(name, joined(m.backend.gather_at_first(Message(column, column + columns.size()))));
      }
  }
}

namespace detail {

/// What was saved under a name, of which there must be so many numbers.
inline std::vector<double> read_exactly(const ReadArray& read, const std::string& name, std::size_t n) {
  std::vector<double> values = read(name);
  if (values.size() != n) throw std::runtime_error(fmt::format("`{}` has {} numbers, not {}", name, values.size(), n));
  return values;
}

/// The tiles as they were: which they are, and in what order they are added up, was decided when particles were last put
/// in order.
template <int Dim>
RunTiles<Dim> read_tiles(const ReadArray& read) {
  const std::vector<double> numbers = read("tiles");
  RunTiles<Dim> run;
  run.places.resize(numbers.size() / (3 * Dim));
  run.cells.resize(run.places.size());
  run.work.assign(run.places.size(), 0);
  for (std::size_t t = 0, i = 0; t < run.places.size(); ++t)
    for (Index<Dim>* corner : {&run.places[t], &run.cells[t].low, &run.cells[t].high})
      for (int a = 0; a < Dim; ++a) (*corner)[a] = int(numbers[i++]);
  return run;
}

/// Takes this owner's particles of a body: those of its tiles, [first, last) of the run.
template <int Dim>
void restore_body(Body<Dim>& body, std::size_t number, const std::vector<double>& begins, std::size_t n,
                  std::size_t first, std::size_t last, const ReadArray& read) {
  const auto begin_of = [&](std::size_t t) { return t < begins.size() ? std::size_t(begins[t]) : n; };
  const std::size_t from = begin_of(first), to = begin_of(last);
  body.particles.resize(int(to - from));
  body.tiles.clear();
  for (std::size_t t = first; t < last; ++t)
    body.tiles.push_back({int(begin_of(t) - from), int(begin_of(t + 1) - from)});
  const ParticleLayout& layout = body.particles.layout();
  for (int f = 0; f < n_particle_fields; ++f)
    for (int k = 0; k < layout.components(ParticleField(f)); ++k) {
      const auto values = read_exactly(read, fmt::format("body {}: {} {}", number, particle_fields[f].name, k), n);
      std::copy(values.begin() + std::ptrdiff_t(from), values.begin() + std::ptrdiff_t(to),
                body.particles.columns().column(layout.begin(ParticleField(f)) + k));
    }
}

}  // namespace detail

/// Of the surfaces' accounts, one after the other.
inline void save_surfaces(const std::vector<SurfaceAccount>& surfaces, const WriteArray& write) {
  std::vector<double> numbers;
  for (const SurfaceAccount& account : surfaces) {
    const std::vector<double> image = image_of(account);
    numbers.insert(numbers.end(), image.begin(), image.end());
  }
  write("surfaces", numbers);
}
inline void restore_surfaces(std::vector<SurfaceAccount>& surfaces, const ReadArray& read) {
  constexpr std::size_t n = sizeof(SurfaceAccount) / sizeof(double);
  const std::vector<double> numbers = detail::read_exactly(read, "surfaces", n * surfaces.size());
  for (std::size_t i = 0; i < surfaces.size(); ++i)
    set_from_image(surfaces[i],
                   {numbers.begin() + std::ptrdiff_t(n * i), numbers.begin() + std::ptrdiff_t(n * (i + 1))});
}

template <int Dim, class Shape>
void restore(Model<Dim, Shape>& m, Ledger& ledger, StepTally& tally, Carried& carried, const ReadArray& read) {
  using namespace detail;
  set_from_image(ledger, read_exactly(read, "ledger", image_of(ledger).size()));
  set_from_image(tally, read_exactly(read, "tally", image_of(tally).size()));
  set_from_image(carried, read_exactly(read, "carried", image_of(carried).size()));
  RunTiles<Dim> run = read_tiles<Dim>(read);
  const std::size_t n_tiles = run.places.size();
  std::vector<std::vector<double>> begins;
  std::vector<std::size_t> sizes;
  m.n_particles = 0;
  for (std::size_t b = 0; b < m.bodies.size(); ++b) {
    const std::size_t n = read(fmt::format("body {}: position 0", b)).size();
    const auto most = m.bodies[b].particles.memory().extent ? m.most_particles : m.n_at_start[b];
    if (n > std::size_t(most))  // fewer if some have left or were merged
      throw std::runtime_error(fmt::format("body {} has {} particles, not {}", b, n, m.n_at_start[b]));
    begins.push_back(read_exactly(read, fmt::format("body {}: first particles of tiles", b), n_tiles));
    sizes.push_back(n);
    m.n_particles += long(n);
    for (std::size_t t = 0; t < n_tiles; ++t)
      run.work[t] += m.bodies[b].cost * long((t + 1 < n_tiles ? begins[b][t + 1] : double(n)) - begins[b][t]);
  }
  add_work_of_nodes<Dim, Shape>(run.work);
  const std::vector<int> owners = owners_of<Dim>({}, run.work, m.backend.n_owners());
  const auto own = std::equal_range(owners.begin(), owners.end(), m.backend.owner());
  for (std::size_t b = 0; b < m.bodies.size(); ++b)
    restore_body<Dim>(m.bodies[b], b, begins[b], sizes[b], std::size_t(own.first - owners.begin()),
                      std::size_t(own.second - owners.begin()), read);
  settle_on_grid(m, std::move(run));
  const std::vector<double> closed = read("closed contacts");
  for (std::size_t i = 0; i + 3 < closed.size(); i += 4) {
    const auto tile = std::lower_bound(m.halo.number.begin(), m.halo.number.end(), long(closed[i]));
    if (!(closed[i] >= 0) || (m.backend.n_owners() == 1 && tile == m.halo.number.end()))
      throw std::runtime_error("`closed contacts` has a tile that is not there");
    if (tile == m.halo.number.end() || *tile != long(closed[i])) continue;  // another owner's
    m.contacts[std::size_t(tile - m.halo.number.begin())].push_back(
        closed_contact(int(closed[i + 1]), int(closed[i + 2]), closed[i + 3] != 0));
  }
}

}  // namespace talus
