#pragma once
/// What can be seen of a run between two steps.

#include <algorithm>
#include <utility>
#include <vector>

#include "talus/mpm/inspect.hpp"
#include "talus/mpm/kernel/gradient.hpp"
#include "talus/mpm/model.hpp"

namespace talus {

/// Strain rates of a body's particles, as the next step would see them; the nodes have their velocities.
template <int Dim, class Shape>
std::vector<SymTensor<double>> strain_rates(Model<Dim, Shape>& m, const ShapedBody<Dim, Shape>& body) {
  std::vector<SymTensor<double>> rates(std::size_t(body.particles.size()), SymTensor<double>::zero());
  m.backend.for_each(m.grid.n_tiles(), [&](int t, int worker) {
    if (!m.has_particles(t)) return;
    const auto points = m.points(body, t);
    if (points.size() == 0) return;
    const auto velocity = m.window_of(t, m.grid.velocity);
    const ScratchView s = m.scratch[std::size_t(worker)].view(points.size());
    find_gradients(points, m.domain, velocity, s);
    for (int i = 0; i < points.size(); ++i)
      rates[std::size_t(points.range.begin) + std::size_t(i)] = symmetric_part(s.gradient_of(i));
  });
  return rates;
}

/// Everything at an instant, or some fields (`Simulation::observe`), of the particles of this owner. If `broken`, particles
/// may stand anywhere: strain rates are zero.
template <int Dim, class Shape>
Observation observe(Model<Dim, Shape>& m, double time, long step, bool broken, const std::vector<std::string>& fields) {
  Observation seen{time, step, {}};
  int number = 0;
  for (const auto& body : m.bodies) {
    const auto rates =
        broken ? std::vector<SymTensor<double>>(std::size_t(body.particles.size()), SymTensor<double>::zero())
               : strain_rates(m, body);
    observe_body<Dim>(body, number++, rates, m.backend, seen, fields);
  }
  return seen;
}

/// Calls f(b, rows, first) on all threads for the particles of each body b in each tile: their rows, and the number of the first one
/// among all that this owner has, tile by tile and in each body by body.
template <int Dim, class Shape, class F>
void for_each_in_tiles(const Model<Dim, Shape>& m, F f) {
  m.backend.for_each(m.grid.n_tiles(), [&](int t, int) {
    if (!m.has_particles(t)) return;
    std::size_t first = 0;
    for (const auto& body : m.bodies) first += std::size_t(body.tiles[std::size_t(t)].begin);
    for (std::size_t b = 0; b < m.bodies.size(); ++b) {
      const RowRange rows = m.bodies[b].tiles[std::size_t(t)];
      f(b, rows, first);
      first += std::size_t(rows.size());
    }
  });
}

/// Of all bodies.
template <int Dim, class Shape>
std::size_t n_own_particles(const Model<Dim, Shape>& m) {
  std::size_t n = 0;
  for (const auto& body : m.bodies) n += std::size_t(body.particles.size());
  return n;
}

/// Puts together what `for_each_in_tiles` has found of the particles of all owners.
template <int Dim, class Shape, class Found>
void gather_by_tiles(const Model<Dim, Shape>& m, Found& found) {
  if (m.backend.n_owners() == 1) return;
  std::vector<double> tiles;
  for (int t = 0; t < m.grid.n_tiles(); ++t) {
    if (!m.has_particles(t)) continue;
    int n = 0;
    for (const auto& body : m.bodies) n += body.tiles[std::size_t(t)].size();
    tiles.insert(tiles.end(), {double(m.halo.number[std::size_t(t)]), double(n)});
  }
  gather(m.backend, tiles, found);
}

template <int Dim, class Shape>
ParticlePlaces places_of(const Model<Dim, Shape>& m) {
  ParticlePlaces own;
  own.resize(n_own_particles(m));
  for_each_in_tiles(m, [&](std::size_t b, const RowRange& rows, std::size_t first) {
    put_places_of<Dim>(m.bodies[b], rows, m.domain.axisymmetric, own, first);
  });
  gather_by_tiles(m, own);
  return own;
}

template <int Dim, class Shape>
FlowPoints flow_of(const Model<Dim, Shape>& m) {
  FlowPoints own;
  own.resize(n_own_particles(m));
  for_each_in_tiles(m, [&](std::size_t b, const RowRange& rows, std::size_t first) {
    const double room = m.most_room[b];
    put_flow_of<Dim>(m.bodies[b], rows, room, room / Model<Dim, Shape>::loosest, own, first);
  });
  gather_by_tiles(m, own);
  return own;
}

/// Of all tiles that hold material which may flow, in the order of their places.
template <int Dim, class Shape>
std::vector<TilePressure> pressures_of(const Model<Dim, Shape>& m) {
  std::vector<TilePressure> own(std::size_t(m.grid.n_tiles()));
  m.backend.for_each(m.grid.n_tiles(), [&](int t, int) {
    if (!m.has_particles(t)) return;
    const Index<Dim>& tile = m.grid.tile(t).place;
    CellPressures<Dim> cells;
    for (const auto& body : m.bodies)
      if (!keeps_neighbours(body.law)) cells.add(body, body.tiles[std::size_t(t)], m.domain, tile);
    own[std::size_t(t)] = cells.sum(tile);
  });
  Message mine;
  for (const TilePressure& p : own)
    if (p.volume > 0)
      mine.insert(mine.end(),
                  {double(p.tile[0]), double(p.tile[1]), double(p.tile[2]), p.volume, p.pressure, p.scatter, p.speed});
  std::vector<TilePressure> all;
  for_each_row(m.backend.gather_at_first(mine), 7, [&](const double* row) {
    all.push_back({{int(row[0]), int(row[1]), int(row[2])}, row[3], row[4], row[5], row[6]});
  });
  std::sort(all.begin(), all.end(), [](const auto& a, const auto& b) { return a.tile < b.tile; });
  return all;
}

template <int Dim, class Shape>
std::string describe_particle(const Model<Dim, Shape>& m, long id) {
  std::string text;
  for (const auto& body : m.bodies)
    for (int i = 0; i < body.particles.size() && text.empty(); ++i)
      if (body.particles.id(i) == id) text = describe<Dim>(body, i);
  return gather(m.backend, text);
}

}  // namespace talus
