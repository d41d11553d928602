/// The update of a law in flow: one particle at a time, a pack at a time, with each integrator.

#include "flow.hpp"
#include "with_libm.hpp"

namespace talus {
namespace {

/// A flow in packs.
template <class Law>
struct PackedFlow {
  using State = typename Law::template State<Pack>;

  Law law;
  std::vector<State> states;
  std::vector<Motion<Pack>> motions;

  explicit PackedFlow(const Flow<Law>& flow)
      : law(flow.law), states(flow.n / pack_width), motions(flow.n / pack_width) {
    for (int i = 0; i < flow.n; ++i) {
      set_lane(states[i / pack_width], i % pack_width, flow.states[i]);
      Motion<Pack>& motion = motions[i / pack_width];
      motion.dt = flow.motions[i].dt;
      set_lane(motion.strain, i % pack_width, flow.motions[i].strain);
      set_lane(motion.strain_rate, i % pack_width, flow.motions[i].strain_rate);
    }
  }
};

/// Updates the particles a pack at a time, again and again from the same states. Says so if they do not flow.
template <class Law>
void update_packs(benchmark::State& timer, const Flow<Law>& flow, const Integration& how) {
  const PackedFlow<Law> packed(flow);
  int n_plastic = 0;
  for (std::size_t i = 0; i < packed.states.size(); ++i) {
    auto state = packed.states[i];
    const Response<Pack> response = packed.law.update(state, packed.motions[i], how);
    for (int lane = 0; lane < pack_width; ++lane) n_plastic += response.outcome[lane] == double(Outcome::plastic);
  }
  // The states of a flow lie on the yield surface to rounding; forward Euler takes some for elastic.
  if (how.scheme != Integrator::forward_euler && n_plastic < 0.99 * flow.n) {
    timer.SkipWithError(("only " + std::to_string(n_plastic) + " particles yield").c_str());
    return;
  }
  for (auto _ : timer)
    for (std::size_t i = 0; i < packed.states.size(); ++i) {
      auto state = packed.states[i];
      auto response = packed.law.update(state, packed.motions[i], how);
      benchmark::DoNotOptimize(state);
      benchmark::DoNotOptimize(response);
    }
  timer.counters["ns"] = ns_per_item(flow.n);
}

/// Largest difference between the law and the law with libm, relative to the pressure.
double difference_from_libm(double p, double step) {
  const std::vector<double> ours = stresses_after(flow_at(case_1_sand(), p, step));
  const std::vector<double> theirs = stresses_with_libm(p, step);
  double largest = 0;
  for (std::size_t i = 0; i < ours.size(); ++i) largest = std::max(largest, std::abs(ours[i] - theirs[i]) / p);
  return largest;
}

const bool laws_registered = [] {
  const auto add = [](const std::string& name, auto f) {
    benchmark::RegisterBenchmark(name.c_str(), f)->Repetitions(n_repetitions)->MinTime(0.05);
  };
  for_each_flow([&](const auto& law, double p, double step) {
    for (const Choice& choice : integrator_choices) {
      const Integration how{Integrator(&choice - integrator_choices), implicit.tolerance};
      const std::string scheme(choice.word);
      add(name_of_benchmark(law, p, step, scheme + ", one"),
          [=](benchmark::State& timer) { update_one_at_a_time(timer, flow_at(law, p, step), how); });
      // The explicit schemes take the lanes of a pack one after the other.
      add(name_of_benchmark(law, p, step, scheme + ", pack"), [=](benchmark::State& timer) {
        const double difference = difference_from_libm(p, step);
        if (difference > 1e-9)
          timer.SkipWithError(("differs from libm by " + std::to_string(difference)).c_str());
        else
          update_packs(timer, flow_at(law, p, step), how);
      });
    }
  });
  register_benchmarks_with_libm();
  return true;
}();

}  // namespace
}  // namespace talus
