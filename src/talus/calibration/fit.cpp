#include "talus/calibration/fit.hpp"

#include <nlopt.hpp>

#include <algorithm>
#include <cmath>

namespace talus {

namespace {

/// Step of differences in a coordinate: some hundred times the relative error of the driver.
constexpr double difference = 2e-3;

double sum_of_squares(const Vector& residuals, const Vector& mask) {
  return residuals.cwiseAbs2().cwiseProduct(mask).sum();
}

/// |r + J s|^2 and its gradient in scaled steps, for NLopt.
struct Subproblem {
  Matrix H;
  Vector g;

  static double evaluate(const std::vector<double>& s, std::vector<double>& gradient, void* self) {
    const auto& q = *static_cast<const Subproblem*>(self);
    const Eigen::Map<const Vector> step(s.data(), Eigen::Index(s.size()));
    const Vector Hs = q.H * step;
    if (!gradient.empty()) Eigen::Map<Vector>(gradient.data(), step.size()) = 2 * (Hs + q.g);
    return step.dot(Hs) + 2 * q.g.dot(step);
  }
};

}  // namespace

Residuals::Residuals(const Calibration& calibration, Backend& loop)
    : calibration_(calibration), loop_(loop), void_ratios_(void_ratios_of_tests(calibration)) {}

Evaluation Residuals::at(const Vector& x) { return at(std::vector<Vector>{x})[0]; }

std::vector<Evaluation> Residuals::at(const std::vector<Vector>& xs) {
  const std::size_t n_tests = calibration_.tests.size();
  std::vector<Evaluation> all(xs.size());
  std::vector<AnyLaw> laws;
  std::vector<std::pair<std::size_t, std::size_t>> tasks;
  for (std::size_t k = 0; k < xs.size(); ++k) {
    laws.push_back(law_at(calibration_, xs[k]));
    all[k].allowed = fault_of(laws[k], void_ratios_).empty();
    all[k].residuals.resize(n_tests);
  }
  for (std::size_t t = 0; t < n_tests; ++t)
    for (std::size_t k = 0; k < xs.size(); ++k)
      if (all[k].allowed) tasks.emplace_back(k, t);
  loop_.for_each(int(tasks.size()), [&](int i, int) {
    const auto [k, t] = tasks[std::size_t(i)];
    const MeasuredTest& test = calibration_.tests[t];
    const std::vector<double> r = residuals_of(test, predict(test, laws[k], calibration_.settings.precision));
    all[k].residuals[t] = Eigen::Map<const Vector>(r.data(), Eigen::Index(r.size()));
  });
  n_evaluations_ += long(xs.size());
  return all;
}

std::vector<Matrix> Residuals::jacobian(const Vector& x, const Evaluation& here, const std::vector<int>& parameters,
                                        bool central) {
  std::vector<Vector> xs;
  for (int p : parameters) {
    Vector ahead = x, behind = x;
    ahead[p] = std::min(1.0, x[p] + difference);
    behind[p] = std::max(0.0, x[p] - difference);
    // Away from the nearer bound, so that differences keep their length.
    if (!central) (x[p] > 0.5 ? ahead : behind)[p] = x[p];
    xs.push_back(ahead);
    xs.push_back(behind);
  }
  std::vector<Vector> asked;
  for (const Vector& one : xs)
    if (one != x) asked.push_back(one);
  const std::vector<Evaluation> found = at(asked);
  std::vector<Matrix> J;
  for (const Vector& r : here.residuals) J.push_back(Matrix::Zero(r.size(), n_free()));
  std::size_t next = 0;
  for (std::size_t i = 0; i < parameters.size(); ++i) {
    const Evaluation* sides[2] = {&here, &here};
    double places[2] = {x[parameters[i]], x[parameters[i]]};
    for (int side = 0; side < 2; ++side) {
      const Vector& one = xs[2 * i + std::size_t(side)];
      if (one == x) continue;
      const Evaluation& e = found[next++];
      if (!e.allowed) continue;
      sides[side] = &e;
      places[side] = one[parameters[i]];
    }
    if (places[0] == places[1]) continue;
    for (std::size_t t = 0; t < J.size(); ++t)
      J[t].col(parameters[i]) = (sides[0]->residuals[t] - sides[1]->residuals[t]) / (places[0] - places[1]);
  }
  return J;
}

RowMask all_rows(const Calibration& calibration) {
  RowMask mask;
  for (const MeasuredTest& test : calibration.tests)
    mask.push_back(Vector::Ones(Eigen::Index(test.n_rows() * test.quantities.size())));
  return mask;
}

RowMask rows_of_stage(const Calibration& calibration, Stage stage) {
  RowMask mask = all_rows(calibration);
  for (std::size_t t = 0; t < mask.size(); ++t) {
    const MeasuredTest& test = calibration.tests[t];
    const bool small_strains = stage == Stage::elasticity || stage == Stage::hardening;
    if (test.kind == TestKind::grain_shear || stage == Stage::rate) {
      if ((test.kind == TestKind::grain_shear) != (stage == Stage::rate)) mask[t].setZero();
      continue;
    }
    if (test.is_led_by_stress()) {
      if (!small_strains) mask[t].setZero();
      continue;
    }
    double largest = 0;
    for (double s : test.leading) largest = std::max(largest, std::abs(s - test.leading.front()));
    for (std::size_t k = 0; k < test.quantities.size(); ++k)
      for (std::size_t i = 0; i < test.n_rows(); ++i) {
        const double strain = std::abs(test.leading[i] - test.leading.front());
        const bool belongs = stage == Stage::elasticity       ? strain <= 0.005
                             : stage == Stage::critical_state ? strain >= 0.7 * largest
                             : stage == Stage::hardening      ? strain <= 0.05
                                                              : true;
        if (!belongs) mask[t][Eigen::Index(k * test.n_rows() + i)] = 0;
      }
  }
  return mask;
}

bool is_empty(const RowMask& mask) {
  return std::all_of(mask.begin(), mask.end(), [](const Vector& m) { return m.isZero(0); });
}

double sum_of_squares(const Evaluation& e, const RowMask& mask) {
  double sum = 0;
  for (std::size_t t = 0; t < mask.size(); ++t) sum += sum_of_squares(e.residuals[t], mask[t]);
  return sum;
}

double objective(const Calibration& calibration, double sum) {
  double weights = 0;
  for (const MeasuredTest& test : calibration.tests)
    for (const MeasuredQuantity& q : test.quantities) weights += q.weight;
  return sum / weights;
}

Vector bounded_step(const Matrix& H, const Vector& g, const Vector& x, double damping,
                    const std::vector<int>& parameters) {
  // Steps in units in which the diagonal of H is 1; a parameter that no row depends on stays.
  std::vector<int> moving;
  for (int p : parameters)
    if (H(p, p) > no_influence * no_influence) moving.push_back(p);
  Vector step = Vector::Zero(x.size());
  if (moving.empty()) return step;
  const auto n = Eigen::Index(moving.size());
  Subproblem subproblem{Matrix(n, n), Vector(n)};
  std::vector<double> low(moving.size()), high(moving.size()), s(moving.size(), 0.0), unit(moving.size());
  for (std::size_t i = 0; i < moving.size(); ++i) {
    unit[i] = 1 / std::sqrt(H(moving[i], moving[i]));
    low[i] = -x[moving[i]] / unit[i];
    high[i] = (1 - x[moving[i]]) / unit[i];
  }
  for (Eigen::Index i = 0; i < n; ++i) {
    subproblem.g[i] = g[moving[std::size_t(i)]] * unit[std::size_t(i)];
    for (Eigen::Index j = 0; j < n; ++j)
      subproblem.H(i, j) =
          H(moving[std::size_t(i)], moving[std::size_t(j)]) * unit[std::size_t(i)] * unit[std::size_t(j)] +
          (i == j ? damping : 0);
  }
  nlopt::opt optimiser(nlopt::LD_SLSQP, unsigned(n));
  optimiser.set_min_objective(&Subproblem::evaluate, &subproblem);
  optimiser.set_lower_bounds(low);
  optimiser.set_upper_bounds(high);
  optimiser.set_ftol_rel(1e-14);
  optimiser.set_maxeval(2000);
  double reached = 0;
  try {
    optimiser.optimize(s, reached);
  } catch (const nlopt::roundoff_limited&) {
    // `s` is the best that was found
  }
  for (std::size_t i = 0; i < moving.size(); ++i) step[moving[i]] = std::clamp(s[i], low[i], high[i]) * unit[i];
  return step;
}

void search(Residuals& residuals, const std::vector<int>& parameters, const RowMask& mask, SearchState& state,
            const ReportIteration& report) {
  const CalibrationSettings& settings = residuals.calibration().settings;
  constexpr double least_damping = 1e-7, most_damping = 1e6;
  Evaluation here = residuals.at(state.x);
  // A resumed search has computed this point before.
  const long evaluations_before = residuals.n_evaluations() - std::max(1, state.evaluations);
  double sum = sum_of_squares(here, mask);
  while (!state.finished) {
    const std::vector<Matrix> J = residuals.jacobian(state.x, here, parameters);
    Matrix H = Matrix::Zero(state.x.size(), state.x.size());
    Vector g = Vector::Zero(state.x.size());
    for (std::size_t t = 0; t < J.size(); ++t) {
      const Matrix weighted = mask[t].asDiagonal() * J[t];
      H += J[t].transpose() * weighted;
      g += weighted.transpose() * here.residuals[t];
    }
    const double before = sum;
    bool accepted = false;
    while (!accepted && state.damping <= most_damping) {
      const Vector step = bounded_step(H, g, state.x, state.damping, parameters);
      const double promised = -(step.dot(H * step) + 2 * g.dot(step));
      if (!(promised > 1e-6 * settings.tolerance * sum)) break;
      const Vector x = (state.x + step).cwiseMax(0).cwiseMin(1);
      Evaluation there = residuals.at(x);
      const double now = there.allowed ? sum_of_squares(there, mask) : INFINITY;
      const double gain = (sum - now) / promised;
      if (now < sum) {
        accepted = true;
        state.x = x;
        here = std::move(there);
        sum = now;
      }
      if (gain > 0.75) state.damping = std::max(least_damping, state.damping / 10);
      if (gain < 0.25) state.damping *= gain > 0 ? 3 : 8;
    }
    ++state.iteration;
    state.evaluations = int(residuals.n_evaluations() - evaluations_before);
    state.finished = !accepted || before - sum <= settings.tolerance * before ||
                     state.evaluations >= settings.evaluations || sum < 1e-14;
    if (!report(state, sum)) return;
  }
}

}  // namespace talus
