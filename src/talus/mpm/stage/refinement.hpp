#pragma once
/// Splits particles that stand for stretched material, and merges alike ones (refinement.hpp), before particles are put
/// in order.

#include <algorithm>
#include <utility>
#include <vector>

#include "talus/mpm/cell_order.hpp"
#include "talus/mpm/refinement.hpp"
#include "talus/mpm/stage/stresses.hpp"

namespace talus {

/// Result of a refinement, over all owners.
struct RefinementCost {
  long n_split = 0, n_merged = 0;
  TileSums particles;  ///< what they hold afterwards; `averaging`: elastic energy lost in merging
};

template <int Dim, class Shape>
class ParticleRefinement {
 public:
  /// Deforms the boxes of particles for `time` [s] with the velocities of the nodes.
  void stretch(Model<Dim, Shape>& m, double time) {
    m.backend.for_each(m.all_tiles, [&](int t, int worker) {
      if (!m.has_particles(t) || m.is_left_out(t)) return;
      const Interpolated<Dim, Shape, MassVelocity> velocity(m.grid.tile(t), m.grid.velocity.data());
      m.for_each_body(t, [&](auto& body, const auto& points) {
        if (!body.particles.memory().extent) return;
        const ScratchView s = m.scratch[std::size_t(worker)].view(points.size());
        find_gradients(points, m.domain, velocity, s);
        for (int i = 0; i < points.size(); i += Pack::width) {
          const int first = points.range.begin + i, count = points.count(i, Pack::width);
          auto S = SymTensor<Pack>::zero();
          for (int lane = 0; lane < count; ++lane) set_lane(S, lane, extent_of(body.particles, first + lane));
          S = stretched(S, s.template gradient_of<Pack>(i), time, longest * m.domain.h);
          for (int lane = 0; lane < count; ++lane)
            set_extent(body.particles, first + lane, lane_of<SymTensor<double>>(S, lane));
        }
      });
    });
  }

  /// Splits and merges; `n_ids`: how many ids have been given so far. Nothing goes into solids as they stand at that
  /// time.
  RefinementCost apply(Model<Dim, Shape>& m, double time, long n_ids) {
    const CellCounts<Dim> counts = count_cells(m);
    RefinementCost cost;
    std::vector<std::vector<Plan>> plans(m.bodies.size());
    for (std::size_t b = 0; b < m.bodies.size(); ++b)
      if (m.bodies[b].particles.memory().extent) plans[b] = plan(m, m.bodies[b], counts, m.mean_masses[b], time);
    const auto total = [&](auto n_of_plan) {
      long mine = 0;
      for (const auto& of_body : plans)
        for (const Plan& p : of_body) mine += long(n_of_plan(p));
      return sum_over_owners(m.backend, mine);
    };
    cost.n_split = total([](const Plan& p) { return p.splits.size(); });
    cost.n_merged = total([](const Plan& p) { return p.mergers.size(); });
    if (m.n_particles + cost.n_split - cost.n_merged > m.most_particles || n_ids + cost.n_split > ParticleIds::most) {
      cost.n_split = 0;
      for (auto& of_body : plans)
        for (Plan& p : of_body) p.splits.clear();
    }
    if (cost.n_split + cost.n_merged == 0) return cost;
    const SumsByTile merging = m.over_tiles([&](int t, int, TileSums& sums) {
      for (std::size_t b = 0; b < m.bodies.size(); ++b) {
        if (plans[b].empty()) continue;
        apply_splits<Dim>(m.bodies[b], plans[b][std::size_t(t)].splits);
        sums[Sum::averaging] += apply_mergers<Dim>(m.bodies[b], plans[b][std::size_t(t)].mergers);
      }
    });
    for (std::size_t b = 0; b < m.bodies.size(); ++b)
      if (m.bodies[b].particles.memory().extent)
        rebuild(m.bodies[b], plans[b], first_ids(m, plans[b], n_ids), m.backend);
    m.n_particles += cost.n_split - cost.n_merged;
    cost.particles = add_up_particles(m);
    cost.particles[Sum::averaging] = m.add_up(merging)[Sum::averaging];
    return cost;
  }

 private:
  /// Edge of what a particle can stand for, in cells: the cells that are looked at are in tiles beside its own.
  static constexpr double longest = 3;

  /// Of a body's particles in a tile.
  struct Plan {
    std::vector<Split> splits;
    std::vector<Merger> mergers;
  };

  /// The first id of new particles of a body in each tile; ids are given in the order of the tiles of the run. `n_ids`: how
  /// many have been given, before and after.
  static std::vector<long> first_ids(const Model<Dim, Shape>& m, const std::vector<Plan>& plans, long& n_ids) {
    Message mine;
    for (std::size_t t = 0; t < plans.size(); ++t)
      if (!plans[t].splits.empty()) mine.insert(mine.end(), {double(m.halo.number[t]), double(plans[t].splits.size())});
    std::vector<std::pair<long, long>> all;  // number of a tile and its splits
    for (const Message& of_owner : m.backend.gather(mine))
      for (std::size_t i = 0; i < of_owner.size(); i += 2) all.emplace_back(long(of_owner[i]), long(of_owner[i + 1]));
    std::sort(all.begin(), all.end());
    std::vector<long> first(plans.size(), 0);
    std::size_t t = 0;  // tiles here have increasing numbers as well
    for (const auto& [number, n] : all) {
      while (t < first.size() && m.halo.number[t] < number) ++t;
      if (t < first.size() && m.halo.number[t] == number) first[t] = n_ids;
      n_ids += n;
    }
    return first;
  }

  /// In the grid's room for stages, whose values are lost.
  static CellCounts<Dim> count_cells(Model<Dim, Shape>& m) {
    const std::size_t n = std::size_t(m.grid.n_occupied()) * CellCounts<Dim>::n;
    CellCounts<Dim> counts(m.grid.template room_for_stages<double>(0, n));
    m.backend.for_each(m.all_tiles, [&](int t, int) {
      if (!m.has_particles(t)) return;
      std::fill_n(counts.of(t), CellCounts<Dim>::n, 0.0);
      for (const auto& body : m.bodies)
        add_counts<Dim>(body, body.tiles[std::size_t(t)], m.domain, m.grid.tile(t), counts.of(t));
    });
    exchange_windows(m.backend, m.halo, counts);
    return counts;
  }

  static std::vector<Plan> plan(Model<Dim, Shape>& m, const ShapedBody<Dim, Shape>& body, const CellCounts<Dim>& counts,
                                double mean_mass, double time) {
    constexpr double rounding = 1e-3;  // halves of halves are as heavy as the limit to rounding
    const MergingRule merging = merging_rule<Dim>(body.spacing, m.domain.h, mean_mass);
    const SplittingRule splitting{m.numerics.particle_splitting, rest_speed_of(m),
                                  2 * (1 - rounding) * mean_mass / most_parts};
    std::vector<Plan> plans(std::size_t(m.grid.n_tiles()));
    m.backend.for_each(m.all_tiles, [&](int t, int) {
      if (!m.has_particles(t) || m.is_left_out(t)) return;
      auto solids = m.contact_finder.solids_beside(m.grid.tile(t).place, time);
      const auto along = [&](const Vec<3>& x, const Vec<3>& offset) { return left_of_offset(m, solids, x, offset); };
      Plan& p = plans[std::size_t(t)];
      const RowRange& range = body.tiles[std::size_t(t)];
      p.splits = find_splits<Dim>(splitting, body, range, m.domain, m.grid.tiles(), t, counts, along);
      p.mergers = find_mergers<Dim>(merging, body, range, m.domain, m.grid.tile(t), p.splits);
    });
    return plans;
  }

  /// What walls and solids leave of an offset to both sides: half the way to a wall at most, nothing into a solid.
  static Vec<3> left_of_offset(const Model<Dim, Shape>& m, typename ContactFinder<Dim>::SolidsBeside& solids,
                               const Vec<3>& x, Vec<3> offset) {
    if (!m.contact_finder.solids().empty()) {
      offset = solids.limited(x, offset);
      offset = -1.0 * solids.limited(x, -1.0 * offset);
    }
    for (int a = 0; a < Dim; ++a)
      for (const int side : {0, 1}) {
        if (is_passable(m.domain.walls[std::size_t(2 * a + side)].kind)) continue;
        const double wall = m.domain.origin[a] + (side == 0 ? 0 : m.domain.h * m.domain.n_cells[a]);
        const double most = 0.5 * std::abs(x[a] - wall);
        offset[a] = std::clamp(offset[a], -most, most);
      }
    return offset;
  }

  /// New particles follow those from which they were split, so that the order of particles does not depend on owners.
  /// `ids`: the first new one in each tile.
  static void rebuild(Body<Dim>& body, const std::vector<Plan>& plans, const std::vector<long>& ids, Backend& backend) {
    Particles<Dim>& p = body.particles;
    std::vector<char> copies(std::size_t(p.size()), 1);
    std::vector<const Split*> split_of(std::size_t(p.size()), nullptr);
    for (const Plan& plan : plans) {
      for (const Split& s : plan.splits) {
        copies[std::size_t(s.particle)] = 2;
        split_of[std::size_t(s.particle)] = &s;
      }
      for (const Merger& pair : plan.mergers) copies[std::size_t(pair.second)] = 0;
    }
    std::vector<int> rows;
    struct Added {
      int row;
      const Split* split;
      long id;
    };
    std::vector<Added> added;
    for (std::size_t t = 0; t < body.tiles.size(); ++t) {
      RowRange& range = body.tiles[t];
      long id = ids[t];
      const int begin = int(rows.size());
      for (int i = range.begin; i < range.end; ++i) {
        for (int k = 0; k < copies[std::size_t(i)]; ++k) rows.push_back(i);
        if (copies[std::size_t(i)] == 2) added.push_back({int(rows.size()) - 1, split_of[std::size_t(i)], id++});
      }
      range = {begin, int(rows.size())};
    }
    reorder(p.columns(), rows, backend);
    for (const auto& [row, split, id] : added) {
      for (int a = 0; a < Dim; ++a) p.position(a)[row] -= 2 * split->offset[a];
      p.set_ids(row, id, p.ancestor(row));
    }
  }
};

}  // namespace talus
