#include "host.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cstdio>

#include "talus/case/material.hpp"
#include "talus/case/start_of_law.hpp"

namespace talus {

HostPoint::HostPoint(std::span<const double> constants, std::string_view array_of_constants, double* state_variables,
                     int n_state_variables)
    : variables_(state_variables) {
  auto read = material_from_constants(constants, array_of_constants);
  if (auto* wrong = std::get_if<std::string>(&read)) {
    fault_ = std::move(*wrong);
    return;
  }
  material_ = std::get<MaterialConstants>(std::move(read));
  const int needed = n_leading_state_variables + state_size_of(material_.law);
  if (n_state_variables < needed)
    fault_ = fmt::format("law `{}` needs {} state variables; there are {}", name_of(material_.law), needed,
                         n_state_variables);
}

void HostPoint::start(const SymTensor<double>& stress) {
  if (variables_[1] != 0) return;
  InitialState initial;
  initial.stress = has_lasting_contacts(material_.law) ? material_.stress_unit * stress : SymTensor<double>::zero();
  initial.void_ratio = variables_[0] > 0 ? variables_[0] : material_.void_ratio;
  initial.background_pressure = material_.background_pressure;
  fault_ = fault_of_start(material_.law, initial);
  if (!fault_.empty()) return;
  const auto numbers = state_at_rest(material_.law, initial);
  if (const auto* reason = std::get_if<std::string>(&numbers)) {
    fault_ = "the initial state is impossible: " + *reason;
    return;
  }
  const auto& values = std::get<std::vector<double>>(numbers);
  std::copy(values.begin(), values.end(), state());
  note(double(Outcome::elastic));
}

void HostPoint::turn(const Tensor<double>& Q) {
  double size = 0;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) size += std::abs(Q[i][j]);
  if (size > 0) turn_point(material_.law, state(), Q);
}

Response<double> HostPoint::step(const SymTensor<double>& strain, double dt, double* tangent) {
  Motion<double> motion{strain, SymTensor<double>::zero(), dt > 0 ? dt : long_time};
  if (dt > 0)
    for (int i = 0; i < 6; ++i) motion.strain_rate[i] = strain[i] / dt;
  Response<double> r = tangent
                           ? update_point_with_tangent(material_.law, state(), motion, material_.integration, tangent)
                           : update_point(material_.law, state(), motion, material_.integration);
  note(r.outcome);
  const double unit = material_.stress_unit;
  if (tangent)
    for (int i = 0; i < 36; ++i) tangent[i] /= unit;
  for (double* work : {&r.stiffness, &r.viscosity, &r.work, &r.plastic_work, &r.collisional_work}) *work /= unit;
  return r;
}

SymTensor<double> HostPoint::stress() const {
  SymTensor<double> s = stress_of_point(material_.law, state());
  for (int i = 0; i < 6; ++i) s[i] /= material_.stress_unit;
  return s;
}

double HostPoint::elastic_energy() const {
  return elastic_energy_of_point(material_.law, state()) / material_.stress_unit;
}

void HostPoint::elastic_stiffness(double* matrix) const {
  double copy[largest_state];
  std::copy(state(), state() + state_size_of(material_.law), copy);
  const Motion<double> at_rest{SymTensor<double>::zero(), SymTensor<double>::zero(), long_time};
  const Response<double> r = update_point(material_.law, copy, at_rest, material_.integration);
  double nu = 0.5;  // of a law without Poisson's ratio, a fluid
  for (const NamedConstant& c : constants_of(material_))
    if (c.name == "nu") nu = c.value;
  const double modulus = r.stiffness / material_.stress_unit;
  const double lambda = modulus * nu / (1 - nu), G = 0.5 * modulus * (1 - 2 * nu) / (1 - nu);
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) matrix[6 * i + j] = i < 3 && j < 3 ? (i == j ? modulus : lambda) : (i == j ? G : 0);
}

void HostPoint::note(double outcome) {
  const double volume = specific_volume_of_point(material_.law, state());
  variables_[0] = volume - 1;
  variables_[1] = 1 + outcome;
}

void report_failure(const char* interface, const std::string& text) {
  std::fprintf(stderr, "talus %s: %s\n", interface, text.c_str());
  std::fflush(stderr);
}

}  // namespace talus
