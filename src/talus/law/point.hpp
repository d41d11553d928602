#pragma once
/// One material point under any law, whose state is an array of numbers: what other programs call (C, UMAT).
///
/// Tension-positive; components xx, yy, zz, xy, yz, zx; shear strains are tensor components. SI units.
/// Nothing here allocates, throws or keeps anything between calls, except where it says so. The numbers are those of the
/// element driver: for one point the same function, for arrays eight points at a time, with the same bits.

#include <string>
#include <variant>
#include <vector>

#include "talus/law/registry.hpp"
#include "talus/law/state_fields.hpp"

namespace talus {

/// The largest `state_size` of all laws.
inline constexpr int largest_state = 64;

/// The fields of the law's state, in order, and how many numbers they are.
std::span<const StateField> state_fields_of(const AnyLaw& law);
int state_size_of(const AnyLaw& law);

/// The state under a given stress, or a sentence why there is none.
std::variant<std::vector<double>, std::string> state_at_rest(const AnyLaw& law, const InitialState& initial);

/// Moves a state through one step.
Response<double> update_point(const AnyLaw& law, double* state, const Motion<double>& motion, const Integration& how);

/// Moves n states through steps of the same length. States lie one after the other, and so do strains and strain rates
/// (6 n numbers each) and responses.
void update_points(const AnyLaw& law, int n, double* states, const double* strains, const double* strain_rates,
                   double dt, const Integration& how, Response<double>* responses);

/// Moves a state through one step and writes the consistent tangent: `tangent[6 i + j]` is the derivative of component i
/// of the stress after the step [Pa] by component j of the strain increment, with engineering shear strains. The strain
/// rate changes by d strain/dt if dt > 0, else it stays.
///
/// The derivative is by differences of `update` about the same state, in each direction at four lengths, each a tenth of
/// the one before, from 1e-2 of the strain over which the stress changes by itself; of successive estimates the two that
/// differ least decide. Differences are central where both neighbours have the outcome of the point, else one-sided
/// (second order) to the side which has it: at a kink the tangent is that of the branch on which the point is.
Response<double> update_point_with_tangent(const AnyLaw& law, double* state, const Motion<double>& motion,
                                           const Integration& how, double* tangent);

/// Stress of a state [Pa].
SymTensor<double> stress_of_point(const AnyLaw& law, const double* state);
/// Energy that unloading gives back [J per m3 of present volume].
double elastic_energy_of_point(const AnyLaw& law, const double* state);
/// Volume over that of the grains (1 + void ratio), or over that at the start: as the law counts it.
double specific_volume_of_point(const AnyLaw& law, const double* state);
/// Rotates what the state remembers: every tensor becomes Q A Q^T.
void turn_point(const AnyLaw& law, double* state, const Tensor<double>& Q);

/// The quantities that can be read off a state (`quantities_of`), one after the other, tensors with six numbers.
void quantities_of_point(const AnyLaw& law, const double* state, const SymTensor<double>& strain_rate, double* values);

/// The step length that stands for infinitely slow loading where only rates matter and there are none: laws with a
/// relaxation of their own (`local_mu_i`) come to rest in it.
inline constexpr double long_time = 1e30;

}  // namespace talus
