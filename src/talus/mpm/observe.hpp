#pragma once
/// What can be seen of a run between two steps.

#include <algorithm>
#include <limits>
#include <utility>
#include <vector>

#include "talus/mpm/cell_order.hpp"
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

/// Rows of so many numbers, of which the first is an id: those of all owners in the order of ids, for the first owner.
class GatheredRows {
 public:
  GatheredRows(Backend& backend, Message mine, std::size_t n_numbers) {
    if (backend.n_owners() == 1)
      all_.push_back(std::move(mine));
    else
      all_ = backend.gather_at_first(mine);
    std::size_t n = 0;
    double first = std::numeric_limits<double>::infinity(), last = -first;
    for_each_row(all_, n_numbers, [&](const double* row) {
      ++n;
      first = std::min(first, *row);
      last = std::max(last, *row);
    });
    if (n == 0) return;
    if (last - first < 4 * double(n)) {  // ids are whole numbers, of which most are there
      rows_.assign(std::size_t(last - first) + 1, nullptr);
      for_each_row(all_, n_numbers, [&](const double* row) { rows_[std::size_t(*row - first)] = row; });
      std::erase(rows_, nullptr);
    } else {
      rows_.reserve(n);
      for_each_row(all_, n_numbers, [&](const double* row) { rows_.push_back(row); });
      std::sort(rows_.begin(), rows_.end(), [](const double* a, const double* b) { return *a < *b; });
    }
  }
  std::size_t size() const { return rows_.size(); }
  auto begin() const { return rows_.begin(); }
  auto end() const { return rows_.end(); }

 private:
  std::vector<Message> all_;
  std::vector<const double*> rows_;
};

/// Of all bodies.
template <int Dim, class Shape>
std::size_t n_own_particles(const Model<Dim, Shape>& m) {
  std::size_t n = 0;
  for (const auto& body : m.bodies) n += std::size_t(body.particles.size());
  return n;
}

template <int Dim, class Shape>
ParticlePlaces places_of(const Model<Dim, Shape>& m) {
  Message mine(n_own_particles(m) * place_row);
  double* rows_of_body = mine.data();
  const std::vector<RowOrder> parts = all_rows(m.bodies, m.backend);
  for (std::size_t b = 0; b < parts.size(); ++b) {
    m.backend.for_each(int(parts[b].size()), [&](int part, int) {
      const RowRange range = parts[b][std::size_t(part)];
      put_places_of<Dim>(m.bodies[b], range, m.domain.axisymmetric,
                         rows_of_body + std::size_t(range.begin) * place_row);
    });
    rows_of_body += std::size_t(m.bodies[b].particles.size()) * place_row;
  }
  const GatheredRows rows(m.backend, std::move(mine), place_row);
  const std::size_t n = rows.size();
  ParticlePlaces all{std::vector<Vec<3>>(n), std::vector<double>(n), std::vector<double>(n), std::vector<long>(n)};
  for_each_of(m.backend, n, [&](std::size_t i) {
    const double* row = rows.begin()[long(i)];
    all.places[i] = {row[1], row[2], row[3]};
    all.sizes[i] = row[4];
    all.masses[i] = row[5];
    all.ancestors[i] = long(row[6]);
  });
  return all;
}

template <int Dim, class Shape>
FlowPoints flow_of(const Model<Dim, Shape>& m) {
  Message mine;
  mine.reserve(n_own_particles(m) * flow_row);
  for (std::size_t b = 0; b < m.bodies.size(); ++b) {
    const double room = m.most_room[b];
    add_flow_of_body<Dim>(m.bodies[b], room, room / Model<Dim, Shape>::loosest, mine);
  }
  FlowPoints points;
  for (const double* row : GatheredRows(m.backend, std::move(mine), flow_row)) {
    points.places.push_back({row[1], row[2], row[3]});
    points.velocities.push_back({row[4], row[5], row[6]});
    points.volumes.push_back(row[7]);
    points.masses.push_back(row[8]);
    points.volumes_at_start.push_back(row[9]);
  }
  return points;
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
