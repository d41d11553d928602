#include "talus/case/defaults.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr Choice integrators[] = {integrator_choices[1], integrator_choices[0], integrator_choices[2]};
constexpr Integrator schemes[] = {Integrator::return_mapping, Integrator::modified_euler, Integrator::forward_euler};

constexpr Option shape{"shape", "shape functions", shape_function_choices};
constexpr Option transfer{"transfer", "transfer of velocities between particles and grid", transfer_choices};
constexpr Option order{"order", "when the stress is updated", order_choices};
constexpr Flag f_bar{"f_bar", "average the rate of volume change over each cell (not with average_pressure)"};
constexpr Flag average_pressure{"average_pressure", "average the pressure of grains over each cell"};
constexpr Flag particle_shifting{"particle_shifting",
                                 "move particles apart where they are closer than their volumes allow"};
constexpr Option particle_splitting{"particle_splitting", "where stretched particles are split", splitting_choices};
constexpr Option integrator{"integrator", "how the frictional stress is integrated", integrators};

/// The words of transfers that have a time constant, or of those that have none.
std::vector<std::string> transfers_with_tau(bool with) {
  std::vector<std::string> words;
  for (int i = 0; i < int(std::size(transfer_choices)); ++i)
    if (has_tau(Transfer(i)) == with) words.emplace_back(transfer_choices[i].word);
  return words;
}

int number_of(Integrator scheme) {
  int i = 0;
  while (schemes[i] != scheme) ++i;
  return i;
}

/// Of a transfer with a time constant. Where it has no default, `resolve` says whether it is missing.
std::optional<double> read_tau(Section& s, const Case& case_) {
  if (const std::optional<Default> by_default = default_tau(case_))
    return s.number(keys::tau, by_default->value, by_default->reason);
  return s.optional_number(keys::tau_without_default);
}

void read_integration(Section& s, Integration& integration) {
  integration.scheme = schemes[s.choice(integrator, number_of(integration.scheme))];
  if (integration.scheme == Integrator::modified_euler)
    integration.tolerance = s.number(keys::tolerance, integration.tolerance);
}

}  // namespace

const Declaration& numerics_declaration() {
  static const Declaration d(
      "[numerics]",
      {optional(keys::preset), optional(shape), optional(transfer),
       optional(keys::tau).with("transfer", transfers_with_tau(true)),
       optional(keys::flip_share).with("transfer", transfers_with_tau(false)), optional(order), optional(f_bar),
       optional(average_pressure), optional(keys::bulk_viscosity), optional(particle_shifting),
       optional(keys::shifting_length), optional(particle_splitting), optional(keys::rest_tolerance),
       optional(integrator), optional(keys::tolerance).with("integrator", {"modified_euler"}), optional(keys::dt),
       optional(keys::cfl), optional(keys::stiffness_factor)});
  return d;
}

void read_numerics(Section& s, Case& case_) {
  Numerics& n = case_.numerics;
  n = numerics_of(Preset(s.choice(keys::preset)));
  n.shape_function = ShapeFunction(s.choice(shape, int(n.shape_function)));
  n.transfer = Transfer(s.choice(transfer, int(n.transfer)));
  if (has_tau(n.transfer))
    n.tau = read_tau(s, case_);
  else
    n.flip_share = s.number(keys::flip_share, n.flip_share);
  n.order = Order(s.choice(order, int(n.order)));
  n.f_bar = s.flag(f_bar, n.f_bar);
  n.average_pressure = s.flag(average_pressure, averages_pressure(n.preset, n.f_bar));
  const Default viscosity = default_bulk_viscosity(n.preset, n.order);
  n.bulk_viscosity = s.number(keys::bulk_viscosity, viscosity.value, viscosity.reason);
  n.particle_shifting = s.flag(particle_shifting, n.particle_shifting);
  n.shifting_length = n.particle_shifting ? s.number(keys::shifting_length, case_.cell, "a cell")
                                          : s.optional_number(keys::shifting_length);
  n.particle_splitting = Splitting(s.choice(particle_splitting, int(n.particle_splitting)));
  n.rest_tolerance = s.number(keys::rest_tolerance, n.rest_tolerance);
  read_integration(s, n.integration);
  if (n.dt)
    n.dt = s.number(keys::dt, *n.dt, "as in the paper");
  else
    n.dt = s.optional_number(keys::dt);
  const Default cfl = default_cfl(case_);
  n.cfl = s.number(keys::cfl, cfl.value, cfl.reason);
  n.stiffness_factor = s.number(keys::stiffness_factor, n.stiffness_factor);
  s.close();
}

}  // namespace talus
