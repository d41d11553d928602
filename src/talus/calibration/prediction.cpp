#include "talus/calibration/prediction.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>

#include "talus/base/error.hpp"
#include "talus/case/material.hpp"
#include "talus/element/driver.hpp"

namespace talus {

namespace {

constexpr double no_value = std::numeric_limits<double>::quiet_NaN();
constexpr double slow = 1e4;  ///< duration of a segment that is led by stress [s]
/// Calls of the law after which a test ends as one that fails: ordinary ones take 1000 to 5000. Parameters for which a test
/// hardly moves on (a critical void ratio that falls to 0) would otherwise take minutes.
constexpr long most_updates = 20000;
constexpr double least_share = 1e-6;  ///< of the measured value, below which a logarithm is cut off

// ---- paths ---------------------------------------------------------------------------------------------------------

double range_of(const std::vector<double>& values) {
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return *high - *low;
}

/// The logarithmic strain of a leading strain since the first row; nominal strains are converted.
double leading_strain(const MeasuredTest& test, double value) {
  const double since = value - test.leading.front();
  return test.nominal && test.kind == TestKind::triaxial ? -std::log(std::max(1e-6, 1 - since)) : since;
}

Controls controls_of(const MeasuredTest& test, Course course) {
  if (test.kind == TestKind::simple_shear)
    return simple_shear(
        test.drainage == TestDrainage::undrained ? ShearDrainage::undrained : ShearDrainage::constant_normal_stress, 0,
        course);
  const TriaxialDrainage drainage = test.drainage == TestDrainage::undrained    ? TriaxialDrainage::undrained
                                    : test.drainage == TestDrainage::constant_p ? TriaxialDrainage::constant_p
                                                                                : TriaxialDrainage::drained;
  return triaxial(drainage, 0, course);
}

/// Leads a strain from one value to another: finely at first, where stresses change most.
void add_strain_segments(const MeasuredTest& test, double from, double to, std::vector<Segment>& segments) {
  const double turn = from + 0.04 * (to - from);
  const struct {
    double from, to;
    int rows;
  } parts[] = {{from, turn, 14}, {turn, to, 40}};
  for (const auto& part : parts) {
    const double change = part.to - part.from;
    if (change == 0) continue;
    Segment segment;
    segment.duration = std::abs(change) / test.strain_rate;
    segment.rows = part.rows;
    segment.controls = controls_of(test, {change / segment.duration, 0});
    segments.push_back(std::move(segment));
  }
}

/// Leads a stress from one value to another, in parts by no more than a factor of 3.
void add_stress_segments(const MeasuredTest& test, double from, double to, std::vector<Segment>& segments) {
  const int n_parts = std::max(1, int(std::ceil(std::abs(std::log(to / from)) / std::log(3.0))));
  for (int i = 1; i <= n_parts; ++i) {
    const double target = i == n_parts ? to : from * std::pow(to / from, double(i) / n_parts);
    Segment segment;
    segment.duration = slow;
    segment.rows = 8;
    segment.controls = test.kind == TestKind::oedometer ? oedometer_to(0, target) : isotropic_compression_to(target);
    segments.push_back(std::move(segment));
  }
}

InitialState initial_state(const AnyLaw& law, double void_ratio, const SymTensor<double>& stress) {
  InitialState initial;
  initial.void_ratio = void_ratio;
  if (has_lasting_contacts(law)) initial.stress = opposite_sign(stress);
  return initial;
}

double k0_of(const AnyLaw& law) {
  return std::visit([](const auto& l) { return l.earth_pressure_at_rest(); }, law);
}

// ---- what is read off ------------------------------------------------------------------------------------------------

/// Columns of a result that quantities are computed from.
struct ResultColumns {
  int strain[6], stress[6];

  explicit ResultColumns(const ElementResult& result) {
    for (int i = 0; i < 6; ++i) {
      strain[i] = result.column(fmt::format("strain_{}", component_names[i]));
      stress[i] = result.column(fmt::format("stress_{}", component_names[i]));
    }
  }
};

/// A row of a result, in the quantities of laboratory tests.
struct Instant {
  const std::vector<double>& row;
  const ResultColumns& at;

  double strain(int i) const { return row[std::size_t(at.strain[i])]; }
  double stress(int i) const { return row[std::size_t(at.stress[i])]; }
  double p() const { return (stress(0) + stress(1) + stress(2)) / 3; }
  double volumetric() const { return strain(0) + strain(1) + strain(2); }
};

/// A quantity of a path at an instant; `start` is the first row.
double value_of(const std::string& name, const MeasuredTest& test, const Instant& now, const Instant& start) {
  const bool shear = test.kind == TestKind::simple_shear;
  const double lateral = 0.5 * (now.stress(1) + now.stress(2));
  if (name == "q") return now.stress(0) - lateral;
  if (name == "p") return now.p();
  if (name == "stress_ratio") return shear ? now.stress(3) / now.stress(1) : (now.stress(0) - lateral) / now.p();
  if (name == "axial_stress") return now.stress(0);
  if (name == "lateral_stress") return lateral;
  if (name == "shear_stress") return now.stress(3);
  if (name == "normal_stress") return now.stress(1);
  if (name == "pore_pressure") return start.stress(1) - now.stress(1);
  if (name == "volumetric_strain") return test.nominal ? 1 - std::exp(-now.volumetric()) : now.volumetric();
  if (name == "axial_strain") return test.nominal ? 1 - std::exp(-now.strain(0)) : now.strain(0);
  if (name == "void_ratio") return (1 + test.void_ratio) * std::exp(-now.volumetric()) - 1;
  return no_value;
}

/// The leading quantity at an instant, since the start where it is a strain.
double leading_at(const MeasuredTest& test, const Instant& now) {
  switch (test.kind) {
    case TestKind::oedometer: return now.stress(0);
    case TestKind::isotropic_compression: return now.p();
    case TestKind::simple_shear: return now.strain(3);
    default: return now.strain(0);
  }
}

/// y at x of a line through points whose x goes one way; the nearer end outside.
double interpolated(const std::vector<double>& xs, const std::vector<double>& ys, double x) {
  if (xs.size() == 1) return ys[0];
  const bool grows = xs.back() >= xs.front();
  std::size_t i = 1;
  while (i + 1 < xs.size() && (grows ? xs[i] < x : xs[i] > x)) ++i;
  const double a = xs[i - 1], b = xs[i];
  const double t = a == b ? 1 : std::clamp((x - a) / (b - a), 0.0, 1.0);
  return ys[i - 1] + t * (ys[i] - ys[i - 1]);
}

Prediction predict_path(const MeasuredTest& test, const AnyLaw& law, double precision) {
  const PathTest path = path_test(test, law, precision);
  const ElementResult result = run_element_test(path.test, most_updates);
  const ResultColumns columns(result);
  Prediction prediction;
  prediction.failure = result.failure;
  const std::vector<Branch> branches = branches_of(test);
  // The rows of each branch; the last one of a branch is the first of the next.
  std::vector<std::vector<std::size_t>> rows(branches.size());
  std::size_t row = 0;
  for (std::size_t s = 0; s < path.branch_of_segment.size(); ++s) {
    std::vector<std::size_t>& of_branch = rows[std::size_t(path.branch_of_segment[s])];
    if (of_branch.empty()) of_branch.push_back(std::min(row, result.rows.size() - 1));
    for (int i = 0; i < path.test.segments[s].rows && row + 1 < result.rows.size(); ++i) of_branch.push_back(++row);
  }
  const Instant start{result.rows.front(), columns};
  for (const MeasuredQuantity& quantity : test.quantities) {
    std::vector<double>& values = prediction.values.emplace_back(test.n_rows(), no_value);
    for (std::size_t b = 0; b < branches.size(); ++b) {
      std::vector<double> xs, ys;
      for (std::size_t r : rows[b]) {
        const Instant now{result.rows[r], columns};
        xs.push_back(leading_at(test, now));
        ys.push_back(value_of(quantity.name, test, now, start));
      }
      if (xs.empty()) continue;
      const bool grows = test.leading[branches[b].last] >= test.leading[branches[b].first];
      for (std::size_t i = branches[b].first; i <= branches[b].last; ++i) {
        const double x = test.is_led_by_stress() ? test.leading[i] : leading_strain(test, test.leading[i]);
        const bool reached = result.failure.empty() || (grows ? x <= xs.back() : x >= xs.back());
        if (reached) values[i] = interpolated(xs, ys, x);
      }
    }
    // Strains are measured from where they were set to zero, computed from the first row.
    if (quantity.name.ends_with("strain") || quantity.name == "pore_pressure")
      for (double& v : values) v += quantity.values.front();
  }
  return prediction;
}

// ---- steady shear --------------------------------------------------------------------------------------------------

struct Sheared {
  double p, tau, normal[3], void_ratio;
};

/// One state of steady shear at constant volume. The stress at the start is the measured one, so that the way to the steady
/// state is short. Rows grow by a constant factor, so the last covers nearly half of the strain; where it still changes a
/// stress by more than 2 % of the pressure, the shear goes on to four times the strain, twice at most. None if the driver
/// fails.
std::optional<Sheared> shear_until_steady(const MeasuredTest& test, const ShearedState& state, double void_ratio,
                                          const AnyLaw& law, double precision, Prediction& prediction, bool& steady) {
  ElementTest element;
  element.law = law;
  element.initial = initial_state(law, void_ratio, SymTensor<double>::isotropic(std::max(state.normal_stress, 1e-9)));
  element.integration = {Integrator::return_mapping, precision};
  element.tolerance = precision;
  Sheared end{};
  double strain = test.steady_strain;
  for (int attempt = 0; attempt < 3; ++attempt, strain *= 4) {
    Segment segment;
    segment.duration = strain / state.shear_rate;
    segment.rows = 12;
    segment.first_row = 1e-3 * segment.duration;
    segment.controls = simple_shear(ShearDrainage::undrained, 0, {0.5 * state.shear_rate, 0});
    element.segments = {segment};
    const ElementResult result = run_element_test(element, most_updates);
    if (!result.failure.empty()) {
      prediction.failure = result.failure;
      return std::nullopt;
    }
    const ResultColumns columns(result);
    const auto at = [&](std::size_t from_end) {
      const Instant now{result.rows[result.rows.size() - 1 - from_end], columns};
      return Sheared{now.p(), now.stress(3), {now.stress(0), now.stress(1), now.stress(2)}, void_ratio};
    };
    end = at(0);
    const Sheared before = at(1);
    steady = std::abs(end.p - before.p) <= 0.02 * std::abs(end.p) &&
             std::abs(end.tau - before.tau) <= 0.02 * std::abs(end.p);
    if (steady) break;
  }
  return end;
}

/// Steady shear under a constant normal stress: the void ratio at which constant volume leads to that stress, by false
/// position (Illinois) on its logarithm. The steady state is the same, and no stress has to be controlled on the way.
std::optional<Sheared> shear_under_normal_stress(const MeasuredTest& test, const ShearedState& state, const AnyLaw& law,
                                                 double precision, Prediction& prediction, bool& steady) {
  std::optional<Sheared> found;
  const auto excess = [&](double e) {
    found = shear_until_steady(test, state, e, law, precision, prediction, steady);
    return found ? std::log(std::max(found->normal[1], 1e-12 * state.normal_stress) / state.normal_stress) : no_value;
  };
  const std::optional<Range> range = void_ratios_of(law);
  double a = state.void_ratio, f_a = excess(a);
  if (!range) return found;
  // Looser where the stress is too high, denser where it is too low.
  double b = a, f_b = f_a;
  for (int i = 0; i < 60 && f_b * f_a > 0; ++i) {
    a = b;
    f_a = f_b;
    b = std::clamp(b + (f_a > 0 ? 0.04 : -0.04), std::max(0.02, range->low + 0.02), std::min(range->high - 0.02, 20.0));
    if (b == a) break;
    f_b = excess(b);
  }
  if (!(f_a * f_b <= 0)) {
    prediction.failure = fmt::format("no void ratio gives a normal stress of {:.4g} Pa at a shear rate of {:.4g} 1/s",
                                     state.normal_stress, state.shear_rate);
    return std::nullopt;
  }
  for (int i = 0; i < 60 && std::abs(f_b) > 1e-5 && std::abs(b - a) > 1e-10; ++i) {
    const double c = (a * f_b - b * f_a) / (f_b - f_a), f_c = excess(c);
    if (!std::isfinite(f_c)) return std::nullopt;
    if (f_c * f_b < 0) {
      a = b;
      f_a = f_b;
    } else {
      f_a *= 0.5;
    }
    b = c;
    f_b = f_c;
  }
  return found;
}

double value_of(const std::string& name, const Sheared& s) {
  if (name == "p") return s.p;
  if (name == "shear_stress") return s.tau;
  if (name == "stress_ratio") return s.p > 0 ? s.tau / s.p : 0;
  if (name == "friction") return s.normal[1] > 0 ? s.tau / s.normal[1] : 0;
  if (name == "void_ratio") return s.void_ratio;
  if (name == "solid_fraction") return 1 / (1 + s.void_ratio);
  if (name == "normal_stress") return s.normal[1];
  const double over = s.p > 0 ? 1 / s.p : 0;
  if (name == "normal_ratio_flow") return s.normal[0] * over;
  if (name == "normal_ratio_gradient") return s.normal[1] * over;
  if (name == "normal_ratio_vorticity") return s.normal[2] * over;
  return no_value;
}

Prediction predict_shear(const MeasuredTest& test, const AnyLaw& law, double precision) {
  Prediction prediction;
  prediction.values.assign(test.quantities.size(), std::vector<double>(test.n_rows(), no_value));
  for (std::size_t i = 0; i < test.states.size(); ++i) {
    bool steady = false;
    const ShearedState& state = test.states[i];
    const std::optional<Sheared> end =
        test.drainage == TestDrainage::constant_normal_stress
            ? shear_under_normal_stress(test, state, law, precision, prediction, steady)
            : shear_until_steady(test, state, state.void_ratio, law, precision, prediction, steady);
    prediction.n_unsteady += !steady;
    for (std::size_t k = 0; k < test.quantities.size() && end; ++k)
      prediction.values[k][i] = value_of(test.quantities[k].name, *end);
  }
  return prediction;
}

}  // namespace

std::vector<Branch> branches_of(const MeasuredTest& test) {
  const std::vector<double>& x = test.leading;
  if (x.empty()) return {};
  const double least = 0.02 * range_of(x);
  std::vector<Branch> branches;
  std::size_t first = 0, extreme = 0;
  int direction = 0;
  for (std::size_t i = 1; i < x.size(); ++i) {
    const double way = x[i] - x[extreme];
    if (direction == 0) {
      if (way != 0) direction = way > 0 ? 1 : -1;
      extreme = i;
    } else if (way * direction >= 0) {
      extreme = i;
    } else if (std::abs(way) > least || (test.is_led_by_stress() && std::abs(way) > 0.25 * std::abs(x[extreme]))) {
      branches.push_back({first, extreme});
      first = extreme;
      extreme = i;
      direction = -direction;
    }
  }
  branches.push_back({first, x.size() - 1});
  return branches;
}

PathTest path_test(const MeasuredTest& test, const AnyLaw& law, double precision) {
  PathTest path;
  path.test.title = test.name;
  path.test.law = law;
  path.test.integration = {Integrator::modified_euler, precision};
  path.test.tolerance = precision;
  const double lateral = test.k0_of_law ? k0_of(law) * test.axial_stress : test.lateral_stress;
  SymTensor<double> stress = SymTensor<double>::zero();
  const bool shear = test.kind == TestKind::simple_shear;
  for (int i = 0; i < 3; ++i) stress[i] = i == (shear ? 1 : 0) ? test.axial_stress : lateral;
  path.test.initial = initial_state(law, test.void_ratio, stress);
  const std::vector<Branch> branches = branches_of(test);
  double at = test.is_led_by_stress() ? test.axial_stress : 0;
  for (std::size_t b = 0; b < branches.size(); ++b) {
    // To the outermost row of the branch, which noise may have put before its last.
    double to = test.leading[branches[b].last];
    const bool grows = to >= test.leading[branches[b].first];
    for (std::size_t i = branches[b].first; i <= branches[b].last; ++i)
      to = grows ? std::max(to, test.leading[i]) : std::min(to, test.leading[i]);
    if (!test.is_led_by_stress()) to = leading_strain(test, to);
    const std::size_t before = path.test.segments.size();
    if (to != at) {
      if (test.is_led_by_stress())
        add_stress_segments(test, at, to, path.test.segments);
      else
        add_strain_segments(test, at, to, path.test.segments);
    }
    at = to;
    path.branch_of_segment.insert(path.branch_of_segment.end(), path.test.segments.size() - before, int(b));
  }
  return path;
}

Prediction predict(const MeasuredTest& test, const AnyLaw& law, double precision) {
  try {
    return test.kind == TestKind::grain_shear ? predict_shear(test, law, precision)
                                              : predict_path(test, law, precision);
  } catch (const InputError& e) {
    Prediction prediction;
    prediction.impossible = true;
    prediction.failure = e.what();
    return prediction;
  }
}

double scale_of(std::string_view quantity, const std::vector<double>& values) {
  if (quantity == "void_ratio" || quantity == "solid_fraction") return range_of(values);
  const auto [low, high] = std::minmax_element(values.begin(), values.end());
  return std::max(std::abs(*low), std::abs(*high));
}

std::vector<std::vector<double>> differences_of(const MeasuredTest& test, const Prediction& prediction) {
  std::vector<std::vector<double>> all;
  for (std::size_t k = 0; k < test.quantities.size(); ++k) {
    const MeasuredQuantity& quantity = test.quantities[k];
    std::vector<double>& of_quantity = all.emplace_back();
    for (std::size_t i = 0; i < quantity.values.size(); ++i) {
      double off = 1;  // of a state that the law cannot carry, and of rows that the driver did not reach
      if (!prediction.impossible && std::isfinite(prediction.values[k][i])) {
        const double measured = quantity.values[i], computed = prediction.values[k][i];
        off = quantity.logarithmic ? std::log(std::max(computed / measured, least_share))
                                   : (computed - measured) / quantity.scale;
      }
      of_quantity.push_back(std::isfinite(off) ? std::clamp(off, -1e3, 1e3) : 1e3);
    }
  }
  return all;
}

std::vector<double> residuals_of(const MeasuredTest& test, const Prediction& prediction) {
  std::vector<double> all;
  const std::vector<std::vector<double>> differences = differences_of(test, prediction);
  for (std::size_t k = 0; k < differences.size(); ++k)
    for (double off : differences[k])
      all.push_back(off * std::sqrt(test.quantities[k].weight / double(differences[k].size())));
  return all;
}

std::vector<double> misfits_of(const MeasuredTest& test, const Prediction& prediction) {
  std::vector<double> misfits;
  for (const std::vector<double>& of_quantity : differences_of(test, prediction)) {
    double sum = 0;
    for (double off : of_quantity) sum += off * off;
    misfits.push_back(std::sqrt(sum / double(std::max<std::size_t>(of_quantity.size(), 1))));
  }
  return misfits;
}

}  // namespace talus
