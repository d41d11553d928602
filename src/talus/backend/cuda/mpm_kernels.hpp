#pragma once
/// The kernels of mpm/kernel/ for a device, a thread for each tile. A struct here holds what a kernel works on for all
/// tiles and calls it for one: what is computed stands in mpm/kernel/, and the host compiles the same.

#include "talus/mpm/kernel/advance.hpp"
#include "talus/mpm/kernel/contact.hpp"
#include "talus/mpm/kernel/filter.hpp"
#include "talus/mpm/kernel/force.hpp"
#include "talus/mpm/kernel/load.hpp"
#include "talus/mpm/kernel/mass_and_momentum.hpp"
#include "talus/mpm/kernel/shift.hpp"
#include "talus/mpm/kernel/stress.hpp"

namespace talus::cuda {

/// Arrays on the device: tiles, the particles of a body, nodes and windows of all tiles.
template <int D, class S>
struct TilesOnDevice {
  static constexpr int Dim = D;
  using Shape = S;
  using Layout = TileLayout<Dim, Shape>;

  const Tile<Dim>* tiles;
  const RowRange* ranges;
  ParticlesView<Dim> particles;
  Shape shape;
  Domain<Dim> domain;
  Mirrors<Dim> walls;
  const bool* near_wall;
  const ScratchView* scratch;  ///< one a tile
  MassMomentum *momentum, *momentum_windows;
  MassVelocity *velocity, *new_velocity;
  ForceStiffness *force, *force_windows;
  Acceleration* acceleration;
  FilterMoments<Dim>* moments;
  FilterFit<Dim>* fits;
  EightMoments* moment_windows;
  double *volume_windows, *filling;
  Crowding* crowding;
  const ContactsView* contacts;
  TileSums* sums;

  TALUS_HD TilePoints<Dim, Shape> points(int t) const { return {particles, ranges[t], tiles[t].place, shape}; }
  template <class Node>
  TALUS_HD static Node* nodes_of(Node* nodal, int t) {
    return nodal + std::size_t(t) * Layout::n_nodes;
  }
  template <class Node>
  TALUS_HD static Node* window_of(Node* windows, int t) {
    return windows + std::size_t(t) * Layout::n_window;
  }
};

struct StepOnDevice {
  double dt, kept, least_mass;
  Quad gravity;
};

template <class M>
struct MassAndMomentum {
  M m;
  TALUS_HD void operator()(int t) const {
    MassMomentum* window = m.window_of(m.momentum_windows, t);
    clear_window<M::Dim, typename M::Shape>(window);
    add_mass_and_momentum(m.points(t), m.domain, window);
  }
};
template <class M, bool apic>
struct AffineMomentum {
  M m;
  TALUS_HD void operator()(int t) const {
    add_affine_momentum<apic>(m.points(t), m.domain, m.window_of(m.momentum_windows, t));
  }
};
template <class M>
struct SumsOverWindows {
  M m;
  TALUS_HD void operator()(int t) const {
    add_windows<M::Dim, typename M::Shape>(m.tiles, t, m.momentum_windows, m.nodes_of(m.momentum, t));
    add_windows<M::Dim, typename M::Shape>(m.tiles, t, m.force_windows, m.nodes_of(m.force, t));
  }
};
template <class M>
struct NodeVelocities {
  M m;
  StepOnDevice step;
  TALUS_HD void operator()(int t) const {
    find_velocities(m.tiles[t].place, m.walls, m.near_wall[t], step.least_mass, m.nodes_of(m.momentum, t),
                    m.nodes_of(m.velocity, t), m.sums[t]);
    meet_surfaces(m.contacts[t], m.tiles[t].place, m.walls, 1 - step.kept, step.least_mass, m.momentum,
                  m.nodes_of(m.velocity, t), m.sums[t]);
  }
};
template <class M>
struct WallsFold {
  M m;
  int mirror;
  TALUS_HD void operator()(int t) const {
    fold_to_originals(m.tiles, t, m.walls.mirrors[mirror], m.momentum);
    fold_to_wall(m.tiles, t, m.walls.mirrors[mirror], m.momentum);
  }
};
template <class M>
struct WallsExtend {
  M m;
  int mirror;
  TALUS_HD void operator()(int t) const {
    extend_to_images(m.tiles, t, m.walls.mirrors[mirror], m.velocity);
    extend_evenly(m.tiles, t, m.walls.mirrors[mirror], m.filling);
    extend_evenly(m.tiles, t, m.walls.mirrors[mirror], m.crowding);
  }
};
template <class M>
struct GainFromWalls {
  M m;
  TALUS_HD void operator()(int t) const {
    m.sums[t].add(Sum::wall_impulse,
                  gain_from_walls(m.tiles[t].place, m.walls, m.near_wall[t], m.nodes_of(m.velocity, t),
                                  m.nodes_of(m.momentum, t), m.nodes_of(m.velocity, t), Quad(0.0)));
  }
};
template <class M>
struct Gradients {
  M m;
  TALUS_HD void operator()(int t) const {
    MassVelocity velocity[M::Layout::n_window];
    fill_window<M::Dim, typename M::Shape>(m.tiles[t], m.velocity, velocity);
    find_gradients(m.points(t), m.domain, velocity, m.scratch[t]);
  }
};
template <class M, class Law, bool f_bar>
struct Stresses {
  M m;
  Law law;
  StressUpdate how;
  TALUS_HD void operator()(int t) const {
    const CellFinder<M::Dim> cells{m.domain.origin, 1 / m.domain.h, m.tiles[t].place};
    update_stress<double, f_bar>(law, m.particles, m.ranges[t], cells, how, m.scratch[t], m.sums[t]);
  }
};
template <class M, bool hoops>
struct Forces {
  M m;
  TALUS_HD void operator()(int t) const {
    ForceStiffness* window = m.window_of(m.force_windows, t);
    clear_window<M::Dim, typename M::Shape>(window);
    add_forces<hoops>(m.points(t), m.domain, m.scratch[t], window);
  }
};
template <class M>
struct Loads {
  M m;
  LoadView load;
  TALUS_HD void operator()(int t) const {
    Vec<3> total{};
    add_load(m.points(t), m.domain, load, m.window_of(m.force_windows, t), total);
    m.sums[t].add(Sum::load_force, total);
  }
};
template <class M>
struct PowerOfLoads {
  M m;
  LoadView load;
  TALUS_HD void operator()(int t) const {
    MassVelocity velocity[M::Layout::n_window];
    fill_window<M::Dim, typename M::Shape>(m.tiles[t], m.velocity, velocity);
    add_power_of_load(m.points(t), m.domain, load, velocity, m.sums[t][Sum::load_power]);
  }
};
template <class M>
struct Accelerations {
  M m;
  StepOnDevice step;
  TALUS_HD void operator()(int t) const {
    accelerate(m.tiles[t].place, m.walls, m.near_wall[t], step.least_mass, step.dt, step.gravity,
               m.nodes_of(m.force, t), m.nodes_of(m.velocity, t), m.nodes_of(m.acceleration, t),
               m.nodes_of(m.new_velocity, t), m.sums[t]);
    rub_on_surfaces(m.contacts[t], m.tiles[t].place, m.walls, {step.dt, m.domain.h}, step.gravity,
                    {m.nodes_of(m.velocity, t), m.velocity, m.nodes_of(m.force, t), m.force},
                    m.nodes_of(m.new_velocity, t), m.nodes_of(m.acceleration, t), m.sums[t]);
  }
};
template <class M, Advance which>
struct Motions {
  M m;
  StepOnDevice step;
  TALUS_HD void operator()(int t) const {
    NodeMotion nodes[M::Layout::n_window];
    fill_window<M::Dim, typename M::Shape>(m.tiles[t], m.new_velocity, m.acceleration, nodes);
    m.sums[t].raise(Most::way_speed2, advance<which>(m.points(t), m.domain, step.dt, step.kept, nodes));
  }
};
template <class M, bool apic>
struct AffineMotion {
  M m;
  TALUS_HD void operator()(int t) const {
    MassVelocity velocity[M::Layout::n_window];
    fill_window<M::Dim, typename M::Shape>(m.tiles[t], m.new_velocity, velocity);
    find_affine_motion<apic>(m.points(t), m.domain, velocity);
  }
};
template <class M>
struct SumsOverParticles {
  M m;
  Vec<M::Dim> gravity;
  TALUS_HD void operator()(int t) const {
    ParticleSums<M::Dim> total;
    add_up_particles(m.points(t), total);
    total.add_to(m.sums[t], gravity, m.domain);
  }
};
template <class M, int octet>
struct FilterMomentsOctet {
  M m;
  TALUS_HD void operator()(int t) const {
    add_filter_moments<octet>(m.points(t), m.domain, m.window_of(m.moment_windows, t));
  }
};
template <class M>
struct FilterFits {
  M m;
  int mirror;
  double least_mass;
  TALUS_HD void operator()(int t) const {
    const auto moments_of = [&](int tile) { return m.nodes_of(m.moments, tile); };
    fold_moments_to_originals(m.tiles, t, m.walls.mirrors[mirror], moments_of);
    fold_moments_on_wall(m.tiles, t, m.walls.mirrors[mirror], moments_of);
    FilterFit<M::Dim>* fits = m.nodes_of(m.fits, t);
    const FilterMoments<M::Dim>* moments = moments_of(t);
    Quad gained(0.0);
    for (int i = 0; i < M::Layout::n_nodes; ++i) {
      fits[i] = fit_velocity(moments[i], least_mass);
      gained = momentum_gained(moments[i], fits[i], gained);
    }
    m.sums[t].add(Sum::wall_impulse, vector_of(gained));
    for (const NodeContact& c : m.contacts[t])
      m.sums[t].add(Sum::wall_impulse,
                    hold_fit(c, moments[c.node], m.domain.h, m.walls.allowed(m.tiles[t].place, c.node), fits[c.node]));
    extend_fits(m.tiles, t, m.walls.mirrors[mirror], m.fits);
  }
};
template <class M>
struct FilteredVelocities {
  M m;
  double share;
  TALUS_HD void operator()(int t) const {
    FilterFit<M::Dim> fits[M::Layout::n_window];
    fill_window<M::Dim, typename M::Shape>(m.tiles[t], m.fits, fits);
    filter_velocities(m.points(t), m.domain, fits, share);
  }
};
template <class M>
struct Volumes {
  M m;
  double most_room;
  TALUS_HD void operator()(int t) const {
    double* window = m.window_of(m.volume_windows, t);
    clear_window<M::Dim, typename M::Shape>(window);
    add_volumes(m.points(t), m.domain, most_room, m.scratch[t], window);
  }
};
template <class M>
struct Excesses {
  M m;
  TALUS_HD void operator()(int t) const {
    double filling[M::Layout::n_window];
    fill_window<M::Dim, typename M::Shape>(m.tiles[t], m.filling, filling);
    find_excess<M::Dim, typename M::Shape>(filling, m.nodes_of(m.crowding, t));
  }
};
template <class M, class Law>
struct SparseOpenings {
  M m;
  Law law;
  TALUS_HD void operator()(int t) const {
    m.sums[t][Sum::averaging] += open_sparse(law, m.particles, m.ranges[t], m.scratch[t]);
  }
};
template <class M>
struct Shifts {
  M m;
  TALUS_HD void operator()(int t) const {
    Crowding crowding[M::Layout::n_window];
    fill_window<M::Dim, typename M::Shape>(m.tiles[t], m.crowding, crowding);
    const auto freely = [](const Vec<3>&, const Vec<3>& shift) { return shift; };
    shift_particles(m.points(t), m.domain, crowding, m.domain.h, freely, m.scratch[t]);
  }
};

}  // namespace talus::cuda
