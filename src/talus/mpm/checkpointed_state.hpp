#pragma once
/// What decides the bits of the steps to come, as named arrays: handed out and taken back, whatever the number of threads
/// and owners.

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "talus/base/image.hpp"
#include "talus/mpm/arrangement.hpp"
#include "talus/mpm/ledger.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus {

/// What a step takes from those before, beside particles, their arrangement, ledger and tally. New members that outlive a
/// step belong here.
struct Carried {
  double drift = 0;       ///< the ways of the fastest particle in each step since particles were put in order [cells]
  double wave_speed = 0;  ///< [m/s]
  double viscosity = 0;   ///< [m2/s]
  double last_dt = std::numeric_limits<double>::infinity();  ///< [s]
  double unfiltered = 0;                                     ///< time since velocities were last filtered [s]
  double unstretched = 0;                                    ///< time since extents went with the flow [s]
  double n_rearranged = 0;                                   ///< how often particles were put in order
  double n_ids = 0;                                          ///< that particles have been given
};

/// The particles of a body in the order of the run, tile by tile, divided into consecutive parts of equal size, one for each
/// owner.
class ParticleOrder {
 public:
  template <int Dim, class Shape>
  ParticleOrder(const Model<Dim, Shape>& m, const Body<Dim>& body) : backend_(&m.backend) {
    Message mine;
    for (std::size_t t = 0; t < body.tiles.size(); ++t)
      if (m.grid.tile(int(t)).owned) mine.insert(mine.end(), {double(m.halo.number[t]), double(body.tiles[t].size())});
    struct InTile {
      long number;  ///< of the tile in the run
      int owner;
      std::size_t n;  ///< particles
    };
    std::vector<InTile> tiles;
    int owner = 0;
    for (const Message& of_owner : backend_->gather(mine)) {
      for (std::size_t i = 0; i < of_owner.size(); i += 2)
        tiles.push_back({long(of_owner[i]), owner, std::size_t(of_owner[i + 1])});
      ++owner;
    }
    std::sort(tiles.begin(), tiles.end(), [](const InTile& a, const InTile& b) { return a.number < b.number; });
    for (const InTile& tile : tiles) {
      begins_.push_back(double(n_));
      n_ += tile.n;
    }
    begins_.push_back(double(n_));

    const std::size_t own = std::size_t(backend_->owner());
    sends_.assign(std::size_t(backend_->n_owners()), 0);
    receives_.assign(sends_.size(), 0);
    for (std::size_t t = 0; t < tiles.size(); ++t) {
      const auto first = std::size_t(begins_[t]), last = first + tiles[t].n;
      const auto in_part_of = [&](std::size_t o) {
        const std::size_t begin = std::max(first, begin_of_part(o)), end = std::min(last, begin_of_part(o + 1));
        return end > begin ? end - begin : 0;
      };
      if (std::size_t(tiles[t].owner) == own)
        for (std::size_t o = 0; o < sends_.size(); ++o) sends_[o] += in_part_of(o);
      if (const std::size_t n = in_part_of(own)) {
        pieces_.emplace_back(tiles[t].owner, n);
        receives_[std::size_t(tiles[t].owner)] += n;
      }
    }
  }

  /// The first particle in each occupied tile of the run, then the number of all.
  const std::vector<double>& begins() const { return begins_; }
  std::size_t n() const { return n_; }
  /// The first particle of an owner's part.
  std::size_t begin_of_part(std::size_t owner) const { return n_ * owner / std::size_t(backend_->n_owners()); }
  std::size_t begin_of_own_part() const { return begin_of_part(std::size_t(backend_->owner())); }

  /// This owner's part of a column, from what it has of it. All owners call it.
  std::vector<double> part_of(const double* column) const {
    std::vector<Message> messages;
    for (const std::size_t n : sends_) {
      messages.emplace_back(column, column + n);
      column += n;
    }
    std::vector<Message> received = backend_->exchange_sized(std::move(messages), receives_);
    if (received.size() == 1) return std::move(received[0]);
    std::vector<const double*> next;
    for (const Message& of_owner : received) next.push_back(of_owner.data());
    std::vector<double> part;
    for (const auto& [owner, n] : pieces_) {
      const double*& from = next[std::size_t(owner)];
      part.insert(part.end(), from, from + n);
      from += n;
    }
    return part;
  }

 private:
  Backend* backend_;
  std::size_t n_ = 0;
  std::vector<double> begins_;
  std::vector<std::size_t> sends_, receives_;        ///< numbers of a column to and from each owner
  std::vector<std::pair<int, std::size_t>> pieces_;  ///< of this owner's part: from which owner, and how many
};

/// Place, first and last cell of all occupied tiles in the order of the run, for the first owner.
template <int Dim, class Shape>
std::vector<double> occupied_tiles_of_run(const Model<Dim, Shape>& m) {
  Message mine;
  for (int t = 0; t < m.grid.n_occupied(); ++t) {
    if (!m.grid.tile(t).owned) continue;
    mine.push_back(double(m.halo.number[std::size_t(t)]));
    for (const Index<Dim>& corner : {m.grid.tile(t).place, m.grid.cells()[t].low, m.grid.cells()[t].high})
      mine.insert(mine.end(), corner.begin(), corner.end());
  }
  constexpr std::size_t n = 3 * Dim;
  const std::vector<Message> all = m.backend.gather_at_first(mine);
  std::vector<const double*> rows;
  for (const Message& of_owner : all)
    for (const double* row = of_owner.data(); row != of_owner.data() + of_owner.size(); row += n + 1)
      rows.push_back(row);
  std::sort(rows.begin(), rows.end(), [](const double* a, const double* b) { return *a < *b; });
  std::vector<double> tiles;
  for (const double* row : rows) tiles.insert(tiles.end(), row + 1, row + 1 + n);
  return tiles;
}

/// An array that the first owner has.
inline StateArray array_of_first(const std::string& name, std::vector<double> values, const Backend& backend) {
  if (backend.owner() != 0) values.clear();
  const std::size_t n = values.size();
  return {name, n, 0, [values = std::move(values)] { return values; }};
}

template <int Dim, class Shape>
std::vector<StateArray> save(const Model<Dim, Shape>& m, const Ledger& ledger, const StepTally& tally,
                             const Carried& carried) {
  std::vector<StateArray> arrays;
  const auto add = [&](const std::string& name, std::vector<double> values) {
    arrays.push_back(array_of_first(name, std::move(values), m.backend));
  };
  add("ledger", image_of(ledger));
  add("tally", image_of(tally));
  add("carried", image_of(carried));
  add("tiles", occupied_tiles_of_run(m));
  std::vector<double> closed;  // tile, node and surface of every closed contact, and whether it sticks
  for (const ClosedContact<Dim>& c : closed_contacts(m))
    closed.insert(closed.end(), {double(c.tile_number), double(c.node), double(c.surface), double(c.sticks)});
  add("closed contacts", std::move(closed));
  if (m.lets_ground_rest()) {
    std::vector<double> resting;
    for (const RestingTile<Dim>& r : resting_tiles(m)) {
      const std::vector<double> numbers = image_of(r.state);
      resting.push_back(double(r.tile_number));
      resting.insert(resting.end(), numbers.begin(), numbers.end());
    }
    add("resting tiles", std::move(resting));
  }
  for (std::size_t b = 0; b < m.bodies.size(); ++b) {
    const auto order = std::make_shared<const ParticleOrder>(m, m.bodies[b]);
    add(fmt::format("body {}: first particles of tiles", b), order->begins());
    const Columns& columns = m.bodies[b].particles.columns();
    const ParticleLayout& layout = m.bodies[b].particles.layout();
    for (int f = 0; f < n_particle_fields; ++f)
      for (int k = 0; k < layout.components(ParticleField(f)); ++k)
        arrays.push_back(
            {fmt::format("body {}: {} {}", b, particle_fields[f].name, k), order->n(), order->begin_of_own_part(),
             [order, column = columns.column(layout.begin(ParticleField(f)) + k)] { return order->part_of(column); }});
  }
  return arrays;
}

namespace detail {

inline std::vector<double> read_all(const ReadArray& read, const std::string& name) {
  return read(name, 0, std::numeric_limits<std::size_t>::max());
}
/// What was saved under a name, of which there must be so many numbers.
inline std::vector<double> read_exactly(const ReadArray& read, const std::string& name, std::size_t n) {
  std::vector<double> values = read_all(read, name);
  if (values.size() != n) throw std::runtime_error(fmt::format("`{}` has {} numbers, not {}", name, values.size(), n));
  return values;
}

/// Ranges of the particles of a body in the run, in increasing order.
using Ranges = std::vector<std::pair<std::size_t, std::size_t>>;

/// Reads a column of `n` numbers piece by piece, so that no owner has all of it, and copies those in the ranges.
inline void read_ranges(const ReadArray& read, const std::string& name, std::size_t n, const Ranges& ranges,
                        double* column) {
  constexpr std::size_t piece = std::size_t(1) << 20;
  auto range = ranges.begin();
  for (std::size_t first = 0;; first += piece) {
    const std::vector<double> values = read(name, first, piece);
    const std::size_t expected = std::min(piece, n - std::min(n, first));
    if (values.size() != expected)
      throw std::runtime_error(fmt::format("`{}` has {} numbers, not {}", name, first + values.size(), n));
    const std::size_t last = first + values.size();
    for (; range != ranges.end() && range->first < last; ++range) {
      const std::size_t from = std::max(first, range->first), to = std::min(last, range->second);
      column = std::copy(values.data() + (from - first), values.data() + (to - first), column);
      if (range->second > last) break;  // goes on in the next piece
    }
    if (values.size() < piece) break;
  }
}

/// The tiles as they were: which they are, and in what order they are added up, was decided when particles were last put
/// in order.
template <int Dim>
RunTiles<Dim> read_tiles(const ReadArray& read) {
  const std::vector<double> numbers = read_all(read, "tiles");
  RunTiles<Dim> run;
  run.places.resize(numbers.size() / (3 * Dim));
  run.cells.resize(run.places.size());
  for (std::size_t t = 0, i = 0; t < run.places.size(); ++t)
    for (Index<Dim>* corner : {&run.places[t], &run.cells[t].low, &run.cells[t].high})
      for (int a = 0; a < Dim; ++a) (*corner)[a] = int(numbers[i++]);
  return run;
}

/// Takes this owner's particles of a body, those of its tiles. `begins`: the first particle of each tile of the run, then
/// the number of all.
template <int Dim>
void restore_body(Body<Dim>& body, std::size_t number, const std::vector<double>& begins,
                  const std::vector<int>& owners, int own, const ReadArray& read) {
  Ranges ranges;
  body.tiles.clear();
  std::size_t n_own = 0;
  for (std::size_t t = 0; t < owners.size(); ++t) {
    if (owners[t] != own) continue;
    const std::size_t from = std::size_t(begins[t]), to = std::size_t(begins[t + 1]);
    body.tiles.push_back({int(n_own), int(n_own + (to - from))});
    n_own += to - from;
    if (!ranges.empty() && ranges.back().second == from)
      ranges.back().second = to;
    else
      ranges.emplace_back(from, to);
  }
  body.particles.resize(n_own);
  const ParticleLayout& layout = body.particles.layout();
  for (int f = 0; f < n_particle_fields; ++f)
    for (int k = 0; k < layout.components(ParticleField(f)); ++k)
      read_ranges(read, fmt::format("body {}: {} {}", number, particle_fields[f].name, k), std::size_t(begins.back()),
                  ranges, body.particles.columns().column(layout.begin(ParticleField(f)) + k));
}

}  // namespace detail

/// Of the surfaces' accounts, one after the other.
inline StateArray save_surfaces(const std::vector<SurfaceAccount>& surfaces, const Backend& backend) {
  std::vector<double> numbers;
  for (const SurfaceAccount& account : surfaces) {
    const std::vector<double> image = image_of(account);
    numbers.insert(numbers.end(), image.begin(), image.end());
  }
  return array_of_first("surfaces", std::move(numbers), backend);
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
  std::vector<long> work(n_tiles, 0);
  m.n_particles = 0;
  for (std::size_t b = 0; b < m.bodies.size(); ++b) {
    begins.push_back(read_exactly(read, fmt::format("body {}: first particles of tiles", b), n_tiles + 1));
    const double n = begins.back().back();
    if (begins.back().front() != 0 || !std::is_sorted(begins.back().begin(), begins.back().end()))
      throw std::runtime_error(fmt::format("the first particles of the tiles of body {} are not in order", b));
    const auto most = m.bodies[b].particles.memory().extent ? m.most_particles : m.n_at_start[b];
    if (n > double(most))  // fewer if some have left or were merged
      throw std::runtime_error(fmt::format("body {} has {} particles, not {}", b, long(n), m.n_at_start[b]));
    m.n_particles += long(n);
    for (std::size_t t = 0; t < n_tiles; ++t) work[t] += cost_at_start * long(begins[b][t + 1] - begins[b][t]);
  }
  add_work_of_nodes<Dim, Shape>(work);
  run.owners = divide<Dim>(m.backend, run.places, work, 0);
  for (std::size_t b = 0; b < m.bodies.size(); ++b)
    restore_body<Dim>(m.bodies[b], b, begins[b], run.owners, m.backend.owner(), read);
  settle_on_grid(m, std::move(run));
  const std::vector<double> closed = read_all(read, "closed contacts");
  for (std::size_t i = 0; i + 3 < closed.size(); i += 4) {
    const auto tile = std::lower_bound(m.halo.number.begin(), m.halo.number.end(), long(closed[i]));
    if (!(closed[i] >= 0) || (m.backend.n_owners() == 1 && tile == m.halo.number.end()))
      throw std::runtime_error("`closed contacts` has a tile that is not there");
    if (tile == m.halo.number.end() || *tile != long(closed[i])) continue;  // another owner's
    m.contacts[std::size_t(tile - m.halo.number.begin())].push_back(
        closed_contact(int(closed[i + 1]), int(closed[i + 2]), closed[i + 3] != 0));
  }
  if (!m.lets_ground_rest()) return;
  constexpr std::size_t n = sizeof(RestState) / sizeof(double);
  const std::vector<double> resting = read_all(read, "resting tiles");
  for (std::size_t i = 0; i + n < resting.size(); i += n + 1) {
    const auto tile = std::lower_bound(m.halo.number.begin(), m.halo.number.end(), long(resting[i]));
    if (tile == m.halo.number.end() || *tile != long(resting[i])) continue;  // another owner's
    const auto first = resting.begin() + std::ptrdiff_t(i + 1);
    set_from_image(m.rests[std::size_t(tile - m.halo.number.begin())].state, {first, first + std::ptrdiff_t(n)});
  }
}

}  // namespace talus
