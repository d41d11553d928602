#pragma once
/// Particles in flow: states and strains that the benchmarks of the laws start from.

#include <benchmark/benchmark.h>

#include <map>
#include <numbers>
#include <random>
#include <sstream>
#include <vector>

#include "law/parameter_sets.hpp"
#include "per_item.hpp"

namespace talus {

/// Pressures [Pa] and strain steps that the laws are timed at. 1 Pa, a
/// fraction of a grain's own weight, is near zero.
inline constexpr double flow_pressures[] = {500e3, 1e3, 1};
inline constexpr double flow_steps[] = {1e-5, 1e-4, 1e-3};

inline const Simsand& frictional(const Simsand& law) { return law; }
inline const Simsand& frictional(const Granular& law) { return law.frictional; }
template <class R>
const Simsand::State<R>& contacts(const Simsand::State<R>& state) {
  return state;
}
template <class R>
const Simsand::State<R>& contacts(const Granular::State<R>& state) {
  return state.frictional;
}

/// A law in flow: some thousand particles, and the step that each is to make next.
template <class Law>
struct Flow {
  using State = typename Law::template State<double>;
  static constexpr int n = 2048;

  Law law;
  std::vector<State> states;
  std::vector<Motion<double>> motions;
};

/// A direction of shear that turns smoothly, different for every particle: cos(w t) A + sin(w t) B for the shear strain
/// t, with A and B of unit size and half a turn in 5 to 20 % of shear.
class TurningShear {
 public:
  explicit TurningShear(std::mt19937_64& random) {
    std::normal_distribution<> normal;
    for (SymTensor<double>* axis : {&a_, &b_}) {
      for (int i = 0; i < 6; ++i) (*axis)[i] = normal(random);
      *axis = deviator(*axis);
      *axis = (1 / deviatoric_strain(*axis)) * *axis;
    }
    rate_ = std::numbers::pi / std::uniform_real_distribution<>(0.05, 0.2)(random);
  }
  SymTensor<double> step(double sheared, double size) const {
    const SymTensor<double> d = std::cos(rate_ * sheared) * a_ + std::sin(rate_ * sheared) * b_;
    return (size / deviatoric_strain(d)) * d;
  }

 private:
  SymTensor<double> a_, b_;
  double rate_;
};

/// The strain with the given deviator that leaves a point at the same pressure.
template <class Law>
Motion<double> at_constant_pressure(const Law& law, const typename Law::template State<double>& state,
                                    const SymTensor<double>& shear) {
  constexpr double rate = 100;  // of shear [1/s], as in a slump
  const double dt = deviatoric_strain(shear) / rate;
  const double x = contacts(state).x, a = frictional(law).growth(contacts(state).skeleton_void_ratio);
  Motion<double> motion;
  double compression = 0, missing = x;
  for (int i = 0; i < 50 && std::abs(missing) > 1e-9 * x; ++i) {
    const SymTensor<double> strain = shear + SymTensor<double>::isotropic(-compression / 3);
    motion = {strain, (1 / dt) * strain, dt};
    auto trial = state;
    law.update(trial, motion, implicit);
    missing = x - contacts(trial).x;
    compression += 0.8 * missing / a;
  }
  return motion;
}

/// Particles of Case 1 that have been sheared by 5 % at constant pressure, from void ratios a little under and over the
/// critical one; the next step, of the given size, goes on the same way.
template <class Law>
Flow<Law> make_flow(const Law& law, double p, double step) {
  std::mt19937_64 random(1);
  const Simsand& sand = frictional(law);
  const double e_c = std::exp(sand.ln_density(std::log(p / atmospheric_pressure), 0.0));
  Flow<Law> flow{law, {}, {}};
  for (int i = 0; i < flow.n; ++i) {
    const TurningShear shear(random);
    InitialState initial;
    initial.stress = SymTensor<double>::isotropic(-p);
    initial.void_ratio = e_c + std::uniform_real_distribution<>(-0.03, 0.03)(random);
    initial.kappa = std::uniform_real_distribution<>(0.01, 0.5)(random);
    auto state = std::get<typename Law::template State<double>>(law.at_rest(initial));
    constexpr double sheared = 0.05, part = 1e-3;
    for (double t = 0; t < sheared; t += part)
      law.update(state, at_constant_pressure(law, state, shear.step(t, part)), implicit);
    flow.states.push_back(state);
    flow.motions.push_back(at_constant_pressure(law, state, shear.step(sheared, step)));
  }
  return flow;
}

/// The same, made when first asked for.
template <class Law>
const Flow<Law>& flow_at(const Law& law, double p, double step) {
  static std::map<std::pair<double, double>, Flow<Law>> made;
  auto found = made.find({p, step});
  if (found == made.end()) found = made.emplace(std::pair{p, step}, make_flow(law, p, step)).first;
  return found->second;
}

/// "simsand/1000_Pa/0.0001/" and what is timed: how the benchmarks of the laws are named.
template <class Law>
std::string name_of_benchmark(const Law& law, double p, double step, const std::string& what) {
  std::ostringstream name;
  name << law.name << '/' << p << "_Pa/" << step << '/' << what;
  return name.str();
}

/// Registers f(law, p, step) for both laws, all pressures and all steps.
template <class F>
void for_each_flow(F f) {
  for (double p : flow_pressures)
    for (double step : flow_steps) {
      f(case_1_sand(), p, step);
      f(case_1(), p, step);
    }
}

/// Updates the particles one at a time, again and again from the same states.
template <class Law>
void update_one_at_a_time(benchmark::State& timer, const Flow<Law>& flow, const Integration& how) {
  for (auto _ : timer)
    for (int i = 0; i < flow.n; ++i) {
      auto state = flow.states[i];
      auto response = flow.law.update(state, flow.motions[i], how);
      benchmark::DoNotOptimize(state);
      benchmark::DoNotOptimize(response);
    }
  timer.counters["ns"] = ns_per_item(flow.n);
}

/// The stresses after the step, particle by particle: what two ways to compute the same must agree in.
template <class Law>
std::vector<double> stresses_after(const Flow<Law>& flow) {
  std::vector<double> components;
  for (int i = 0; i < flow.n; ++i) {
    auto state = flow.states[i];
    flow.law.update(state, flow.motions[i], implicit);
    const SymTensor<double> stress = flow.law.total_stress(state);
    for (int c = 0; c < 6; ++c) components.push_back(stress[c]);
  }
  return components;
}

}  // namespace talus
