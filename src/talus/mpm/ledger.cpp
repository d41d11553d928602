#include "talus/mpm/ledger.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

void Ledger::start(const TileSums& particles, double elastic_energy) {
  set_particles(particles);
  elastic = initial_elastic = elastic_energy;
  initial = kinetic + potential + elastic;
}

void Ledger::add_gravity(const Vec<3>& gravity, double step_length) {
  for (int a = 0; a < 3; ++a) gravity_impulse[a] += step_length * mass * gravity[a];
}

void Ledger::add_filter(const TileSums& contacts, const TileSums& particles) {
  const double before = kinetic;
  set_particles(particles);
  wall_impulse = wall_impulse + contacts.vector(Sum::wall_impulse) + particles.vector(Sum::wall_impulse);
  numerical += before - kinetic + contacts[Sum::wall_work];
  wall_work -= contacts[Sum::wall_work];
}

void Ledger::add_velocities(const TileSums& nodes) {
  numerical += kinetic - nodes[Sum::held_kinetic] + nodes[Sum::wall_work];
  wall_work -= nodes[Sum::wall_work];
}

void Ledger::add_stresses(const TileSums& tiles, double step_length, double felt) {
  wall_impulse = wall_impulse + felt * tiles.vector(Sum::wall_impulse);
  load_impulse = load_impulse + step_length * tiles.vector(Sum::load_force);
  elastic = tiles[Sum::elastic];
  plastic += tiles[Sum::plastic_work];
  averaging += tiles[Sum::averaging];
  viscous += tiles[Sum::viscous_work];
  numerical -= tiles[Sum::internal_work] + tiles[Sum::viscous_work];
  collisional += tiles[Sum::collisional_work];
  returned += tiles[Sum::returned_work];
  n_separated = long(tiles[Sum::separated]);
  n_unconverged += long(tiles[Sum::unconverged]);
}

void Ledger::add_forces(const TileSums& tiles, double step_length, double felt) {
  wall_impulse = wall_impulse + felt * tiles.vector(Sum::wall_impulse);
  load_impulse = load_impulse + step_length * tiles.vector(Sum::load_force);
}

void Ledger::add_accelerations(const TileSums& nodes) {
  numerical += nodes[Sum::new_kinetic] + nodes[Sum::grid_work] - nodes[Sum::gravity_work];
  wall_friction += nodes[Sum::wall_friction];
  wall_work -= nodes[Sum::wall_work];
}

void Ledger::add_particle_velocities(const TileSums& nodes, double step_length) {
  wall_impulse = wall_impulse + step_length * nodes.vector(Sum::wall_impulse);
}

void Ledger::add_motion(const TileSums& particles, double step_length) {
  // Potential energy that particles lose beyond the work of gravity, because they move with the velocity at the end of
  // the step.
  numerical += potential;
  set_particles(particles);
  wall_impulse = wall_impulse + step_length * particles.vector(Sum::wall_impulse);
  rest_impulse = rest_impulse + particles.vector(Sum::rest_impulse);
  numerical -= kinetic + potential;
  load_work += step_length * particles[Sum::load_power];
  numerical +=
      step_length * particles[Sum::load_power];  // replaces the work of loads at the nodes, which is kinetic energy
}

void Ledger::add_shift(const TileSums& particles) {
  const double before = potential;
  set_particles(particles);
  numerical += before - potential;
  averaging += particles[Sum::averaging];
  elastic -= particles[Sum::averaging];
}

void Ledger::add_refinement(long split, long merged, const TileSums& particles) {
  if (split + merged == 0) return;
  n_split += split;
  n_merged += merged;
  const double before = kinetic + potential;
  set_particles(particles);
  numerical += before - kinetic - potential;
  averaging += particles[Sum::averaging];
  elastic -= particles[Sum::averaging];
}

void Ledger::add_outflow(const Outflow& out) {
  const auto move = [](auto& from, auto& to, const auto& what) {
    from = from - what;
    to = to + what;
  };
  move(mass, outflow.mass, out.mass);
  move(momentum, outflow.momentum, out.momentum);
  move(kinetic, outflow.kinetic, out.kinetic);
  move(potential, outflow.potential, out.potential);
  move(elastic, outflow.elastic, out.elastic);
  for (std::size_t i = 0; i < out.mass_through.size(); ++i) outflow.mass_through[i] += out.mass_through[i];
  for (std::size_t i = 0; i < out.places.size(); ++i) outflow.places[i].add(out.places[i]);
}

void Ledger::add_periods(const TileSums& particles) {
  const double before = potential;
  set_particles(particles);
  initial += potential - before;
}

void Ledger::end_step(double step_length) {
  const double all_kinetic = kinetic + outflow.kinetic;
  const double released = initial - initial_elastic - all_kinetic - potential - outflow.potential;
  turnover = std::max({turnover, all_kinetic, std::abs(released), std::abs(wall_work), std::abs(load_work)});
  dt = step_length;
  time += step_length;
  ++step;
}

void Ledger::set_particles(const TileSums& particles) {
  kinetic = particles[Sum::kinetic];
  potential = particles[Sum::potential];
  momentum = particles.vector(Sum::momentum);
  mass = particles[Sum::mass];
  max_speed = std::sqrt(particles[Most::particle_speed2]);
}

}  // namespace talus
