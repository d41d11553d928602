#include "talus/law/point.hpp"

#include <cstring>
#include <limits>

namespace talus {

namespace {

template <class Law>
typename Law::template State<double> state_from(const double* numbers) {
  static_assert(state_size<Law> <= largest_state);
  typename Law::template State<double> state;
  std::memcpy(&state, numbers, sizeof state);
  return state;
}
template <class State>
void put(const State& state, double* numbers) {
  std::memcpy(numbers, &state, sizeof state);
}

template <class Law>
void update_all(const Law& law, int n, double* states, const double* strains, const double* rates, double dt,
                const Integration& how, Response<double>* responses) {
  constexpr int size = state_size<Law>;
  for (int first = 0; first < n; first += pack_width) {
    const int count = std::min(pack_width, n - first);
    typename Law::template State<Pack> state;
    Motion<Pack> motion{{}, {}, dt};
    for (int lane = 0; lane < pack_width; ++lane) {
      const int i = first + std::min(lane, count - 1);  // lanes beyond repeat the last point
      set_lane(state, lane, state_from<Law>(states + std::size_t(i) * size));
      for (int k = 0; k < 6; ++k) {
        motion.strain[k].set(lane, strains[6 * i + k]);
        motion.strain_rate[k].set(lane, rates[6 * i + k]);
      }
    }
    const Response<Pack> response = law.update(state, motion, how);
    for (int lane = 0; lane < count; ++lane) {
      put(lane_of<typename Law::template State<double>>(state, lane), states + std::size_t(first + lane) * size);
      if (responses) responses[first + lane] = lane_of<Response<double>>(response, lane);
    }
  }
}

double norm(const SymTensor<double>& a) { return std::sqrt(double_dot(a, a)); }

// ---- the tangent -------------------------------------------------------------------------------------------------

constexpr int n_lengths = 4, n_offsets = 4;            // of differences; of neighbours at each length
constexpr double offsets[n_offsets] = {-2, -1, 1, 2};  // in lengths
constexpr int n_neighbours = 6 * n_lengths * n_offsets;

/// Strain that would change the stress by its own magnitude. Elastic: stress over stiffness; viscous: the increment.
double strain_scale(const SymTensor<double>& stress, const Response<double>& r, const Motion<double>& motion) {
  const double by_stress = r.stiffness > 0 ? norm(stress) / r.stiffness : 0, by_increment = norm(motion.strain);
  const double scale = by_stress > 0 ? by_stress : by_increment;
  return std::min(std::max(scale, 1e-9), 1e-2);
}

/// A derivative from the stresses at the four offsets and in the middle.
double derivative(const double (&stress)[n_offsets], double middle, const bool (&same)[n_offsets], double h) {
  if (same[1] && same[2]) {
    const double narrow = (stress[2] - stress[1]) / (2 * h);
    if (!(same[0] && same[3])) return narrow;
    return (4 * narrow - (stress[3] - stress[0]) / (4 * h)) / 3;
  }
  if (same[2] && same[3]) return (4 * stress[2] - stress[3] - 3 * middle) / (2 * h);
  if (same[1] && same[0]) return -(4 * stress[1] - stress[0] - 3 * middle) / (2 * h);
  if (same[2]) return (stress[2] - middle) / h;
  if (same[1]) return (middle - stress[1]) / h;
  return (stress[2] - stress[1]) / (2 * h);
}

template <class Law>
Response<double> update_with_tangent(const Law& law, double* numbers, const Motion<double>& motion,
                                     const Integration& how, double* tangent) {
  using State = typename Law::template State<double>;
  constexpr int size = state_size<Law>;
  State state = state_from<Law>(numbers);
  const State before = state;
  const Response<double> response = law.update(state, motion, how);
  const SymTensor<double> stress = Law::total_stress(state);
  // All neighbours at once: by direction, length and offset.
  double states[n_neighbours * size], strains[n_neighbours * 6], rates[n_neighbours * 6];
  Response<double> responses[n_neighbours];
  const double longest = 1e-2 * strain_scale(stress, response, motion);
  const auto length = [&](int l) {
    double h = longest;
    for (; l > 0; --l) h *= 0.1;
    return h;
  };
  const auto index = [](int direction, int l, int o) { return (direction * n_lengths + l) * n_offsets + o; };
  for (int j = 0; j < 6; ++j)
    for (int l = 0; l < n_lengths; ++l)
      for (int o = 0; o < n_offsets; ++o) {
        const int i = index(j, l, o);
        put(before, states + i * size);
        for (int k = 0; k < 6; ++k) {
          strains[6 * i + k] = motion.strain[k];
          rates[6 * i + k] = motion.strain_rate[k];
        }
        const double change = offsets[o] * length(l) * (j < 3 ? 1 : 0.5);  // half an engineering shear strain
        strains[6 * i + j] += change;
        if (motion.dt > 0) rates[6 * i + j] += change / motion.dt;
      }
  update_all(law, n_neighbours, states, strains, rates, motion.dt, how, responses);

  for (int j = 0; j < 6; ++j) {
    double estimates[n_lengths][6];
    for (int l = 0; l < n_lengths; ++l) {
      SymTensor<double> s[n_offsets];
      bool same[n_offsets];
      for (int o = 0; o < n_offsets; ++o) {
        const int i = index(j, l, o);
        s[o] = Law::total_stress(state_from<Law>(states + i * size));
        same[o] = responses[i].outcome == response.outcome;
      }
      for (int k = 0; k < 6; ++k)
        estimates[l][k] = derivative({s[0][k], s[1][k], s[2][k], s[3][k]}, stress[k], same, length(l));
    }
    int best = 1;
    double least = std::numeric_limits<double>::infinity();
    for (int l = 1; l < n_lengths; ++l) {
      double difference = 0;
      for (int k = 0; k < 6; ++k) difference = std::max(difference, std::abs(estimates[l][k] - estimates[l - 1][k]));
      if (difference < least) {
        least = difference;
        best = l;
      }
    }
    for (int k = 0; k < 6; ++k) tangent[6 * k + j] = estimates[best][k];
  }
  put(state, numbers);
  return response;
}

}  // namespace

std::span<const StateField> state_fields_of(const AnyLaw& any_law) {
  return std::visit([]<class Law>(const Law&) { return state_fields<Law>(); }, any_law);
}

int state_size_of(const AnyLaw& any_law) {
  return std::visit([]<class Law>(const Law&) { return state_size<Law>; }, any_law);
}

std::variant<std::vector<double>, std::string> state_at_rest(const AnyLaw& any_law, const InitialState& initial) {
  return std::visit(
      [&]<class Law>(const Law& law) -> std::variant<std::vector<double>, std::string> {
        const auto state = law.at_rest(initial);
        if (const auto* reason = std::get_if<std::string>(&state)) return *reason;
        std::vector<double> numbers(std::size_t(state_size<Law>));
        put(std::get<typename Law::template State<double>>(state), numbers.data());
        return numbers;
      },
      any_law);
}

Response<double> update_point(const AnyLaw& any_law, double* numbers, const Motion<double>& motion,
                              const Integration& how) {
  return std::visit(
      [&]<class Law>(const Law& law) {
        auto state = state_from<Law>(numbers);
        const Response<double> response = law.update(state, motion, how);
        put(state, numbers);
        return response;
      },
      any_law);
}

void update_points(const AnyLaw& any_law, int n, double* states, const double* strains, const double* strain_rates,
                   double dt, const Integration& how, Response<double>* responses) {
  std::visit([&](const auto& law) { update_all(law, n, states, strains, strain_rates, dt, how, responses); }, any_law);
}

Response<double> update_point_with_tangent(const AnyLaw& any_law, double* state, const Motion<double>& motion,
                                           const Integration& how, double* tangent) {
  return std::visit([&](const auto& law) { return update_with_tangent(law, state, motion, how, tangent); }, any_law);
}

SymTensor<double> stress_of_point(const AnyLaw& any_law, const double* state) {
  return std::visit([&]<class Law>(const Law&) { return Law::total_stress(state_from<Law>(state)); }, any_law);
}

double elastic_energy_of_point(const AnyLaw& any_law, const double* state) {
  return std::visit([&]<class Law>(const Law& law) { return law.elastic_energy(state_from<Law>(state)); }, any_law);
}

double specific_volume_of_point(const AnyLaw& any_law, const double* state) {
  return std::visit([&]<class Law>(const Law& law) { return law.specific_volume(state_from<Law>(state)); }, any_law);
}

void turn_point(const AnyLaw& any_law, double* numbers, const Tensor<double>& Q) {
  std::visit(
      [&]<class Law>(const Law&) {
        auto state = state_from<Law>(numbers);
        Law::turn(state, Q);
        put(state, numbers);
      },
      any_law);
}

void quantities_of_point(const AnyLaw& any_law, const double* numbers, const SymTensor<double>& strain_rate,
                         double* values) {
  std::visit(
      [&]<class Law>(const Law& law) {
        const auto state = state_from<Law>(numbers);
        for (const auto& q : Law::quantities()) {
          q.evaluate(law, state, strain_rate, values);
          values += q.components;
        }
      },
      any_law);
}

}  // namespace talus
