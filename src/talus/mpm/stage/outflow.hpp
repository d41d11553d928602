#pragma once
/// Takes out of the run the particles that have left through sides that let out. Until particles are put in order they
/// stay on outside, for a tenth of a cell or so.

#include <algorithm>
#include <numeric>
#include <vector>

#include "talus/mpm/cell_order.hpp"
#include "talus/mpm/ledger.hpp"
#include "talus/mpm/model.hpp"

namespace talus {

/// What particles from `first` on of all owners' parts of a body hold, added up in the order of a single owner. `tiles`: the
/// number of the tile that each of them was in. `place_of(x)`: the number of the place in `Outflow::places` where a particle
/// leaves.
template <int Dim, class Shape, class PlaceOf>
Outflow held_by_particles(const Model<Dim, Shape>& m, const Body<Dim>& body, int first,
                          const std::vector<double>& tiles, PlaceOf place_of, long& n) {
  const Particles<Dim>& p = body.particles;
  const std::vector<double> energies = elastic_energies<Dim>(body, {first, p.size()});
  Message mine;
  for (int i = first; i < p.size(); ++i) {
    mine.insert(mine.end(), {tiles[std::size_t(i - first)], p.mass()[i]});
    for (int a = 0; a < Dim; ++a) mine.insert(mine.end(), {p.velocity(a)[i], p.position(a)[i]});
    mine.push_back(energies[std::size_t(i - first)]);
  }
  const std::vector<Message> all = m.backend.gather(mine);
  std::vector<const double*> rows;
  for (const Message& of_owner : all)
    for (const double* row = of_owner.data(); row != of_owner.data() + of_owner.size(); row += 2 * Dim + 3)
      rows.push_back(row);
  std::stable_sort(rows.begin(), rows.end(), [](const double* a, const double* b) { return *a < *b; });
  Outflow out;
  n = long(rows.size());
  for (const double* row : rows) {
    const double mass = row[1];
    out.mass += mass;
    for (int a = 0; a < Dim; ++a) {
      const double v = row[2 + 2 * a], x = row[3 + 2 * a];
      out.momentum[a] += mass * v;
      out.kinetic += 0.5 * mass * v * v;
      out.potential -= mass * m.gravity[a] * x;
    }
    out.elastic += row[2 * Dim + 2];
    const Vec<2> x{row[3], row[5]};
    out.places[place_of(x)].add(mass, x);
  }
  return out;
}

/// Takes out the particles whose place `is_out`, through the way of that number (`Outflow::mass_through`), and notes in the
/// ledger what they took along, and where: `place_of(x)` is the number in `Outflow::places`.
template <int Dim, class Shape, class IsOut, class PlaceOf>
void let_out_through(Model<Dim, Shape>& m, std::size_t way, IsOut is_out, PlaceOf place_of, Ledger& ledger) {
  for (auto& body : m.bodies) {
    Particles<Dim>& p = body.particles;
    std::vector<int> order(std::size_t(p.size()));
    std::iota(order.begin(), order.end(), 0);
    const auto first_out = std::stable_partition(order.begin(), order.end(), [&](int i) { return !is_out(p, i); });
    const int kept = int(first_out - order.begin());
    std::vector<double> tiles_left;
    if (kept < p.size()) {
      const std::vector<double> tiles = tile_numbers<Dim>(body, m.halo, m.backend);
      for (auto i = first_out; i != order.end(); ++i) tiles_left.push_back(tiles[std::size_t(*i)]);
      int begin = 0;
      for (RowRange& range : body.tiles) {
        int end = begin;
        for (int i = range.begin; i < range.end; ++i) end += !is_out(p, i);
        range = {begin, end};
        begin = end;
      }
      reorder(p.columns(), order, m.backend);
    }
    if (kept == p.size() && m.backend.n_owners() == 1) continue;
    long n_left = 0;
    Outflow out = held_by_particles<Dim, Shape>(m, body, kept, tiles_left, place_of, n_left);
    if (n_left == 0) continue;
    out.mass_through[way] = out.mass;
    ledger.add_outflow(out);
    m.n_particles -= n_left;
    p.resize(kept);
  }
}

/// Lets out what is beyond sides that let out, and what is over ground whose height is not known.
template <int Dim, class Shape>
void let_out(Model<Dim, Shape>& m, Ledger& ledger) {
  for (int side = 0; side < 2 * Dim; ++side) {
    if (!m.domain.lets_out(side)) continue;
    const int axis = side / 2;
    const auto is_out = [&](const Particles<Dim>& p, int i) {
      const double x = (p.position(axis)[i] - m.domain.origin[axis]) / m.domain.h;
      return side % 2 == 0 ? x < 0 : x > m.domain.n_cells[axis];
    };
    let_out_through(
        m, std::size_t(side), is_out, [&](const Vec<2>&) { return std::size_t(side); }, ledger);
  }
  if constexpr (Dim == 3)
    for (const Solid& solid : m.contact_finder.solids())
      if (const auto* ground = std::get_if<Ground>(&solid.shape); ground && ground->surface->has_gaps())
        let_out_through(
            m, unknown_ground,
            [&](const Particles<Dim>& p, int i) {
              return !ground->surface->is_known(p.position(0)[i], p.position(1)[i]);
            },
            [&](const Vec<2>& x) { return place_of_gap(ground->surface->gap_at(x[0], x[1])); }, ledger);
}

}  // namespace talus
