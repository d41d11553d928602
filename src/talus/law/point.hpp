#pragma once
/// One material point under any law, with its state as an array of numbers: interface for other programs (C, UMAT).
///
/// Tension-positive; components xx, yy, zz, xy, yz, zx; shear strains are tensor components. SI units.
/// Functions do not allocate, throw or keep data between calls, unless stated. Results are bit-identical to those of
/// the element driver, for one point and for arrays, which are updated in packs.

#include <string>
#include <variant>
#include <vector>

#include "talus/law/registry.hpp"
#include "talus/law/state_fields.hpp"

namespace talus {

/// The largest `state_size` of all laws.
inline constexpr int largest_state = 64;

/// The fields of the state of a law, in order, and their total number of components.
std::span<const StateField> state_fields_of(const AnyLaw& law);
int state_size_of(const AnyLaw& law);

/// The state under a given stress, or the reason why it is impossible.
std::variant<std::vector<double>, std::string> state_at_rest(const AnyLaw& law, const InitialState& initial);

/// Updates a state by one step.
Response<double> update_point(const AnyLaw& law, double* state, const Motion<double>& motion, const Integration& how);

/// Updates n states by steps of the same length. States lie one after the other, and so do strains and strain rates
/// (6 n numbers each) and responses.
void update_points(const AnyLaw& law, int n, double* states, const double* strains, const double* strain_rates,
                   double dt, const Integration& how, Response<double>* responses);

/// Updates a state by one step and computes the consistent tangent: `tangent[6 i + j]` is the derivative of component i
/// of the stress after the step [Pa] by component j of the strain increment, with engineering shear strains. The strain
/// rate changes by d strain/dt if dt > 0, else it stays.
///
/// The derivative is by differences of `update` about the same state, in each direction at four lengths, each a tenth
/// of the one before, from 1e-2 of the strain that would change the stress by its own magnitude; the two successive
/// estimates that differ least determine the result. Differences are central where both neighbours have the outcome of
/// the point, else one-sided (second order) to the side which has it: at a kink the tangent is that of the branch on
/// which the point is.
Response<double> update_point_with_tangent(const AnyLaw& law, double* state, const Motion<double>& motion,
                                           const Integration& how, double* tangent);

/// Stress of a state [Pa].
SymTensor<double> stress_of_point(const AnyLaw& law, const double* state);
/// Energy released by unloading [J per m3 of present volume].
double elastic_energy_of_point(const AnyLaw& law, const double* state);
/// Volume relative to that of the grains (1 + void ratio) or to that at the start, depending on the law.
double specific_volume_of_point(const AnyLaw& law, const double* state);
/// Rotates the state: every tensor A becomes Q A Q^T.
void turn_point(const AnyLaw& law, double* state, const Tensor<double>& Q);

/// The quantities of a state (`quantities_of`) in their order; tensors have six numbers.
void quantities_of_point(const AnyLaw& law, const double* state, const SymTensor<double>& strain_rate, double* values);

/// Step length of infinitely slow loading, for calls without a time step: laws with relaxation (`local_mu_i`) come to
/// rest in it.
inline constexpr double long_time = 1e30;

}  // namespace talus
