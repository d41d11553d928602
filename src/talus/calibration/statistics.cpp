#include "talus/calibration/statistics.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "talus/base/error.hpp"
#include "talus/base/text.hpp"
#include "talus/base/units.hpp"
#include "talus/case/material.hpp"

namespace talus {

namespace {

constexpr double undetermined = std::numeric_limits<double>::quiet_NaN();
/// Eigenvalue of the scaled J^T J below which a combination of parameters is not determined.
constexpr double flat = 0.01;

/// A curve of a test in its residuals.
struct FittedCurve {
  std::size_t test;
  Eigen::Index first, n;
};
std::vector<FittedCurve> fitted_curves(const Calibration& calibration) {
  std::vector<FittedCurve> curves;
  for (std::size_t t = 0; t < calibration.tests.size(); ++t) {
    const auto n = Eigen::Index(calibration.tests[t].n_rows());
    for (std::size_t k = 0; k < calibration.tests[t].quantities.size(); ++k)
      if (calibration.tests[t].quantities[k].weight > 0) curves.push_back({t, Eigen::Index(k) * n, n});
  }
  return curves;
}

Matrix sub_matrix(const Matrix& A, const std::vector<int>& chosen) {
  const auto n = Eigen::Index(chosen.size());
  Matrix B(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) B(i, j) = A(chosen[std::size_t(i)], chosen[std::size_t(j)]);
  return B;
}

/// The inverse of a symmetric matrix; directions that the data do not determine at all get a large variance.
Matrix inverse_of(const Matrix& H) {
  const Vector scale = H.diagonal().cwiseSqrt().cwiseMax(1e-300).cwiseInverse();
  const Eigen::SelfAdjointEigenSolver<Matrix> eigen(scale.asDiagonal() * H * scale.asDiagonal());
  const Vector inverse = eigen.eigenvalues().cwiseMax(1e-10).cwiseInverse();
  return scale.asDiagonal() * (eigen.eigenvectors() * inverse.asDiagonal() * eigen.eigenvectors().transpose()) *
         scale.asDiagonal();
}

Matrix sum_of_products(const std::vector<Matrix>& jacobian, const std::vector<char>& counts) {
  Matrix H = Matrix::Zero(jacobian[0].cols(), jacobian[0].cols());
  for (std::size_t t = 0; t < jacobian.size(); ++t)
    if (counts[t]) H += jacobian[t].transpose() * jacobian[t];
  return H;
}

/// Joins groups that share a member.
void join(std::vector<std::vector<int>>& groups, std::vector<int> members) {
  std::sort(members.begin(), members.end());
  for (std::size_t i = 0; i < groups.size();) {
    const bool shares = std::any_of(groups[i].begin(), groups[i].end(), [&](int m) {
      return std::find(members.begin(), members.end(), m) != members.end();
    });
    if (!shares) {
      ++i;
      continue;
    }
    members.insert(members.end(), groups[i].begin(), groups[i].end());
    groups.erase(groups.begin() + std::ptrdiff_t(i));
  }
  std::sort(members.begin(), members.end());
  members.erase(std::unique(members.begin(), members.end()), members.end());
  groups.push_back(members);
}

/// Groups of parameters whose correlations are too close, or that only a flat direction of J^T J holds together.
std::vector<std::vector<int>> find_inseparable(const Statistics& s) {
  std::vector<std::vector<int>> groups;
  for (std::size_t i = 0; i < s.interior.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (std::abs(s.correlation(s.interior[i], s.interior[j])) > too_correlated)
        join(groups, {s.interior[i], s.interior[j]});
  if (s.interior.size() > 1) {
    const Matrix H = sub_matrix(s.H, s.interior);
    const Vector scale = H.diagonal().cwiseSqrt().cwiseInverse();
    const Eigen::SelfAdjointEigenSolver<Matrix> eigen(scale.asDiagonal() * H * scale.asDiagonal());
    for (Eigen::Index k = 0; k < eigen.eigenvalues().size(); ++k) {
      if (eigen.eigenvalues()[k] > flat) break;
      std::vector<int> members;
      for (std::size_t i = 0; i < s.interior.size(); ++i)
        if (std::abs(eigen.eigenvectors()(Eigen::Index(i), k)) > 0.4) members.push_back(s.interior[i]);
      if (members.size() > 1) join(groups, members);
    }
  }
  std::sort(groups.begin(), groups.end());
  return groups;
}

/// Derivatives of a tied parameter in the coordinates of `parameters`; 0 in the others.
Vector gradient_of_tie(const Calibration& calibration, const TiedParameter& tie, const Vector& x,
                       const std::vector<int>& parameters) {
  Vector gradient = Vector::Zero(x.size());
  for (int p : parameters) {
    Vector ahead = x, behind = x;
    ahead[p] = std::min(1.0, x[p] + 1e-5);
    behind[p] = std::max(0.0, x[p] - 1e-5);
    gradient[p] = (value_of_tie(tie, law_at(calibration, ahead)) - value_of_tie(tie, law_at(calibration, behind))) /
                  (ahead[p] - behind[p]);
  }
  return gradient;
}

std::string list_of(const Calibration& calibration, const std::vector<int>& parameters) {
  std::vector<std::string_view> names;
  for (int p : parameters) names.push_back(calibration.free[std::size_t(p)].key);
  return any_of(names, "and");
}

}  // namespace

double correlation_time(const Vector& series) {
  const double variance = series.squaredNorm();
  if (!(variance > 0)) return 1;
  double tau = 1;
  for (Eigen::Index lag = 1; lag < series.size(); ++lag) {
    const Eigen::Index n = series.size() - lag;
    const double rho = series.head(n).dot(series.tail(n)) / variance;
    if (rho < 0.05) break;
    tau += 2 * rho;
  }
  return std::min(tau, double(series.size()));
}

Statistics statistics_at(const Calibration& calibration, const Vector& x, const Evaluation& here,
                         const std::vector<Matrix>& jacobian) {
  Statistics s;
  const Eigen::Index n = x.size();
  s.H = sum_of_products(jacobian, std::vector<char>(jacobian.size(), 1));
  s.information = Matrix::Zero(Eigen::Index(jacobian.size()), n);
  for (Eigen::Index p = 0; p < n; ++p) {
    const FreeParameter& free = calibration.free[std::size_t(p)];
    ParameterEstimate e;
    e.value = from_coordinate(free, x[p]);
    e.standard_error = undetermined;
    e.at_min = x[p] < 1e-4;
    e.at_max = x[p] > 1 - 1e-4;
    e.informed = std::sqrt(s.H(p, p)) > no_influence;
    if (e.informed && !e.at_min && !e.at_max) s.interior.push_back(int(p));
    for (std::size_t t = 0; t < jacobian.size() && s.H(p, p) > 0; ++t)
      s.information(Eigen::Index(t), p) = jacobian[t].col(p).squaredNorm() / s.H(p, p);
    s.parameters.push_back(e);
  }
  s.correlation = Matrix::Constant(n, n, undetermined);
  const auto m = Eigen::Index(s.interior.size());
  Matrix middle = Matrix::Zero(m, m);
  for (const FittedCurve& c : fitted_curves(calibration)) {
    const Vector r = here.residuals[c.test].segment(c.first, c.n);
    Matrix J(c.n, m);
    for (Eigen::Index i = 0; i < m; ++i)
      J.col(i) = jacobian[c.test].col(s.interior[std::size_t(i)]).segment(c.first, c.n);
    const double tau = correlation_time(r);
    s.independent_data += double(c.n) / tau;
    middle += (r.squaredNorm() / double(c.n) * tau) * (J.transpose() * J);
  }
  if (m > 0) {
    const Matrix inverse = inverse_of(sub_matrix(s.H, s.interior));
    const double spare = std::max(1.0, s.independent_data - double(m));
    const Matrix covariance = inverse * middle * inverse * (s.independent_data / spare);
    Matrix all = Matrix::Zero(n, n);
    for (Eigen::Index i = 0; i < m; ++i)
      for (Eigen::Index j = 0; j < m; ++j) {
        const int a = s.interior[std::size_t(i)], b = s.interior[std::size_t(j)];
        s.correlation(a, b) = inverse(i, j) / std::sqrt(inverse(i, i) * inverse(j, j));
        all(a, b) = covariance(i, j);
      }
    for (int p : s.interior) {
      const double in_coordinate = std::sqrt(std::max(0.0, all(p, p)));
      s.parameters[std::size_t(p)].standard_error =
          in_coordinate * std::abs(slope_of(calibration.free[std::size_t(p)], x[p]));
      s.parameters[std::size_t(p)].weak = 4 * in_coordinate > 0.5;
    }
    s.inseparable = find_inseparable(s);
    for (const TiedParameter& tie : calibration.tied) {
      const Vector gradient = gradient_of_tie(calibration, tie, x, s.interior);
      s.tied_errors.push_back(std::sqrt(std::max(0.0, gradient.dot(all * gradient))));
    }
  }
  s.tied_errors.resize(calibration.tied.size(), undetermined);
  for (const TiedParameter& tie : calibration.tied) s.tied_values.push_back(value_of_tie(tie, law_at(calibration, x)));
  return s;
}

std::vector<std::string> findings_of(const Calibration& calibration, const Statistics& s) {
  std::vector<std::string> all;
  for (std::size_t p = 0; p < s.parameters.size(); ++p) {
    const FreeParameter& free = calibration.free[p];
    const ParameterEstimate& e = s.parameters[p];
    if (e.at_min || e.at_max)
      all.push_back(
          fmt::format("{} is at its {} bound, {}: the tests would move it further. It has no standard error. Check "
                      "whether the bound is physical, or fix the parameter from another source.",
                      free.key, e.at_min ? "lower" : "upper", rounded_with_unit(e.value, free.unit, 4)));
    if (!e.informed)
      all.push_back(fmt::format("{} is not identifiable: no test depends on it ({}). Its value is the start value.",
                                free.key, free.meaning));
  }
  for (const std::vector<int>& group : s.inseparable) {
    double most = 0;
    for (int a : group)
      for (int b : group)
        if (a < b) most = std::max(most, std::abs(s.correlation(a, b)));
    const std::string how = group.size() == 2
                                ? fmt::format("their correlation is {:.2f}", s.correlation(group[0], group[1]))
                                : fmt::format("correlations up to {:.3f}", most);
    all.push_back(
        fmt::format("{} are not identifiable one by one from these tests: {}. The others can compensate a change of "
                    "one. Fix one of them from another source, or use the {} together only.",
                    list_of(calibration, group), how, group.size() == 2 ? "two" : "set"));
  }
  for (std::size_t i = 0; i < s.interior.size(); ++i)
    for (std::size_t j = 0; j < i; ++j) {
      const int a = s.interior[j], b = s.interior[i];
      const double rho = s.correlation(a, b);
      if (std::abs(rho) < closely_correlated || std::abs(rho) > too_correlated) continue;
      all.push_back(fmt::format(
          "{} and {} are closely correlated ({:.2f}): in these tests, one compensates an error of the other; "
          "change them together only.",
          calibration.free[std::size_t(a)].key, calibration.free[std::size_t(b)].key, rho));
    }
  for (std::size_t p = 0; p < s.parameters.size(); ++p)
    if (s.parameters[p].weak) {
      const FreeParameter& free = calibration.free[p];
      all.push_back(fmt::format(
          "{} is poorly determined: two standard errors exceed half of the range between its bounds ({} to {}).",
          free.key, rounded_with_unit(free.min, free.unit, 4), rounded_with_unit(free.max, free.unit, 4)));
    }
  if (s.independent_data < 3 * double(s.interior.size()))
    all.push_back(fmt::format(
        "The tests contain about {:.0f} independent values for {} parameters: the standard errors are rough estimates.",
        s.independent_data, s.interior.size()));
  return all;
}

std::vector<std::string> groups_of(const Calibration& calibration) {
  std::vector<std::string> groups;
  for (const MeasuredTest& test : calibration.tests)
    if (std::find(groups.begin(), groups.end(), test.group) == groups.end()) groups.push_back(test.group);
  return groups;
}

std::vector<LeftOut> leave_one_out(Residuals& residuals, const Vector& x, const Evaluation& here,
                                   const std::vector<Matrix>& jacobian) {
  const Calibration& calibration = residuals.calibration();
  const std::size_t n_tests = calibration.tests.size();
  std::vector<int> all;
  for (Eigen::Index p = 0; p < x.size(); ++p) all.push_back(int(p));
  struct Fit {
    std::vector<char> counts;
    Matrix H;
    Vector x;
    Evaluation here;
    double sum;
  };
  std::vector<Fit> fits;
  std::vector<LeftOut> left;
  const auto sum_of = [&](const Fit& fit, const Evaluation& e) {
    double sum = 0;
    for (std::size_t t = 0; t < n_tests; ++t)
      if (fit.counts[t]) sum += e.residuals[t].squaredNorm();
    return sum;
  };
  for (const std::string& group : groups_of(calibration)) {
    LeftOut& one = left.emplace_back();
    one.group = group;
    std::vector<char> counts(n_tests, 1);
    for (std::size_t t = 0; t < n_tests; ++t)
      if (calibration.tests[t].group == group) {
        counts[t] = 0;
        one.tests.push_back(int(t));
      }
    Fit fit{counts, sum_of_products(jacobian, counts), x, here, 0};
    fit.sum = sum_of(fit, here);
    fits.push_back(std::move(fit));
  }
  for (int round = 0; round < 2; ++round) {
    std::vector<Vector> trials;
    for (const Fit& fit : fits) {
      Vector g = Vector::Zero(x.size());
      for (std::size_t t = 0; t < n_tests; ++t)
        if (fit.counts[t]) g += jacobian[t].transpose() * fit.here.residuals[t];
      trials.push_back((fit.x + bounded_step(fit.H, g, fit.x, 1e-3, all)).cwiseMax(0).cwiseMin(1));
    }
    std::vector<Evaluation> found = residuals.at(trials);
    for (std::size_t i = 0; i < fits.size(); ++i) {
      if (!found[i].allowed) continue;
      const double sum = sum_of(fits[i], found[i]);
      if (!(sum < fits[i].sum)) continue;
      fits[i].x = trials[i];
      fits[i].here = std::move(found[i]);
      fits[i].sum = sum;
    }
  }
  for (std::size_t i = 0; i < left.size(); ++i) {
    left[i].x = fits[i].x;
    for (int t : left[i].tests) {
      double weights = 0;
      for (const MeasuredQuantity& q : calibration.tests[std::size_t(t)].quantities) weights += q.weight;
      left[i].misfits_with.push_back(std::sqrt(here.residuals[std::size_t(t)].squaredNorm() / weights));
      left[i].misfits_without.push_back(std::sqrt(fits[i].here.residuals[std::size_t(t)].squaredNorm() / weights));
    }
  }
  return left;
}

Vector jackknife_errors(const std::vector<LeftOut>& left) {
  Vector mean = Vector::Zero(left[0].x.size()), sum = mean;
  for (const LeftOut& one : left) mean += one.x / double(left.size());
  for (const LeftOut& one : left) sum += (one.x - mean).cwiseAbs2();
  return (sum * (double(left.size() - 1) / double(left.size()))).cwiseSqrt();
}

namespace {

/// Void ratios at which a laboratory can make specimens: the smallest and the largest of the tests that are not flows; of the
/// flows, if there are no others.
std::vector<double> void_ratios_of_specimens(const Calibration& calibration) {
  std::vector<double> all;
  for (const MeasuredTest& test : calibration.tests)
    if (test.kind != TestKind::grain_shear && test.void_ratio > 0) all.push_back(test.void_ratio);
  if (all.empty()) return void_ratios_of_tests(calibration);
  const auto [least, most] = std::minmax_element(all.begin(), all.end());
  return *least < *most ? std::vector<double>{*least, *most} : std::vector<double>{*least};
}

/// Largest mean stress at the start of a test, or leading stress: what the parameters were fitted to [Pa].
double largest_stress(const Calibration& calibration) {
  double largest = 0;
  for (const MeasuredTest& test : calibration.tests) {
    largest = std::max(largest, (test.axial_stress + 2 * test.lateral_stress) / 3);
    for (const ShearedState& state : test.states) largest = std::max(largest, state.normal_stress);
    if (test.is_led_by_stress())
      for (double stress : test.leading) largest = std::max(largest, stress);
  }
  return largest;
}

}  // namespace

std::vector<FurtherTest> further_tests(const Calibration& calibration) {
  std::vector<FurtherTest> all;
  if (!has_lasting_contacts(calibration.law)) return all;
  const bool counts_voids = void_ratios_of(calibration.law).has_value();
  std::vector<double> void_ratios = void_ratios_of_specimens(calibration);
  if (void_ratios.empty() || !counts_voids) void_ratios = {0};
  const double most = 10 * largest_stress(calibration);
  const auto add = [&](TestKind kind, TestDrainage drainage, double e, double p, double end,
                       std::vector<std::pair<std::string, std::string>> quantities, const std::string& words) {
    if (p > most || (kind == TestKind::isotropic_compression && end > most)) return;
    MeasuredTest test;
    test.kind = kind;
    test.drainage = drainage;
    test.void_ratio = e;
    test.axial_stress = test.lateral_stress = p;
    constexpr int n = 50;
    for (int i = 0; i <= n; ++i) {
      const double share = double(i) / n;
      test.leading.push_back(test.is_led_by_stress() ? p * std::pow(end / p, share) : end * share);
    }
    for (auto& [name, unit] : quantities)
      test.quantities.push_back({name, unit, std::vector<double>(test.leading.size(), 0), 1, 1, false});
    all.push_back(
        {fmt::format("{} from {}{}", words, with_unit(p, "Pa"), counts_voids ? fmt::format(", e = {:.3g}", e) : ""),
         std::move(test)});
  };
  for (double e : void_ratios)
    for (double p : {20e3, 100e3, 500e3, 2e6}) {
      add(TestKind::triaxial, TestDrainage::undrained, e, p, 0.25, {{"q", "Pa"}, {"p", "Pa"}},
          "an undrained triaxial test");
      add(TestKind::triaxial, TestDrainage::undrained, e, p, -0.15, {{"q", "Pa"}, {"p", "Pa"}},
          "an undrained triaxial extension test");
      add(TestKind::triaxial, TestDrainage::drained, e, p, 0.3, {{"q", "Pa"}, {"volumetric_strain", "1"}},
          "a drained triaxial test");
      add(TestKind::simple_shear, TestDrainage::undrained, e, p, 0.2, {{"shear_stress", "Pa"}, {"normal_stress", "Pa"}},
          "an undrained simple shear test");
      add(TestKind::isotropic_compression, TestDrainage::drained, e, p, 10 * p, {{"void_ratio", "1"}},
          fmt::format("an isotropic compression to {}", with_unit(10 * p, "Pa")));
    }
  return all;
}

namespace {

/// J^T J of a test that is not measured: measured values are those predicted at x.
Matrix products_of_candidate(const Calibration& calibration, const Vector& x, MeasuredTest test) {
  const double precision = calibration.settings.precision;
  const Prediction at_x = predict(test, law_at(calibration, x), precision);
  const Eigen::Index n = x.size();
  if (at_x.impossible || !at_x.failure.empty()) return Matrix::Zero(n, n);
  for (std::size_t k = 0; k < test.quantities.size(); ++k) {
    MeasuredQuantity& q = test.quantities[k];
    q.values = at_x.values[k];
    q.scale = scale_of(q.name, q.values);
    if (!(q.scale > 0)) return Matrix::Zero(n, n);
    if (q.name.ends_with("strain"))  // as if measured from its first row
      for (double& v : q.values) v -= at_x.values[k].front();
  }
  const std::vector<double> here = residuals_of(test, predict(test, law_at(calibration, x), precision));
  Matrix J = Matrix::Zero(Eigen::Index(here.size()), n);
  for (Eigen::Index p = 0; p < n; ++p) {
    Vector there = x;
    there[p] += x[p] > 0.5 ? -4e-3 : 4e-3;
    const std::vector<double> r = residuals_of(test, predict(test, law_at(calibration, there), precision));
    for (std::size_t i = 0; i < r.size(); ++i) J(Eigen::Index(i), p) = (r[i] - here[i]) / (there[p] - x[p]);
  }
  return J.transpose() * J;
}

double largest_error(const Matrix& H, const std::vector<int>& interior, const std::vector<int>& of) {
  const Matrix inverse = inverse_of(sub_matrix(H, interior));
  double largest = 0;
  for (std::size_t i = 0; i < interior.size(); ++i)
    if (std::find(of.begin(), of.end(), interior[i]) != of.end())
      largest = std::max(largest, std::sqrt(inverse(Eigen::Index(i), Eigen::Index(i))));
  return largest;
}

}  // namespace

std::vector<Suggestion> suggest_tests(Residuals& residuals, const Vector& x, const Statistics& s) {
  const Calibration& calibration = residuals.calibration();
  std::vector<std::vector<int>> wanted = s.inseparable;
  for (int p : s.interior) {
    const bool in_group = std::any_of(wanted.begin(), wanted.end(),
                                      [&](const auto& g) { return std::find(g.begin(), g.end(), p) != g.end(); });
    if (s.parameters[std::size_t(p)].weak && !in_group) wanted.push_back({p});
  }
  std::vector<Suggestion> all;
  if (wanted.empty()) return all;
  const std::vector<FurtherTest> candidates = further_tests(calibration);
  std::vector<Matrix> H(candidates.size());
  residuals.loop().for_each(int(candidates.size()), [&](int i, int) {
    H[std::size_t(i)] = products_of_candidate(calibration, x, candidates[std::size_t(i)].test);
  });
  for (const std::vector<int>& group : wanted) {
    Suggestion best{group, "", 1};
    const double now = largest_error(s.H, s.interior, group);
    for (std::size_t i = 0; i < candidates.size(); ++i) {
      const double factor = largest_error(s.H + H[i], s.interior, group) / now;
      if (factor < best.factor) best = {group, candidates[i].words, factor};
    }
    if (best.factor < 0.9) all.push_back(best);
  }
  return all;
}

}  // namespace talus
