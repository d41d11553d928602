#include "talus/element/driver.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>

#include "talus/base/error.hpp"
#include "talus/element/segment.hpp"
#include "talus/mechanics/invariants.hpp"

namespace talus {

namespace {

/// A tension-positive tensor as a compression-positive vector, and back.
Vector6 in_soil_sign(const SymTensor<double>& a) {
  const SymTensor<double> b = opposite_sign(a);
  Vector6 v;
  for (int i = 0; i < 6; ++i) v[i] = b[i];
  return v;
}
SymTensor<double> from_soil_sign(const Vector6& v) {
  return opposite_sign(SymTensor<double>{v[0], v[1], v[2], v[3], v[4], v[5]});
}

template <class Law>
class Driver {
 public:
  using State = typename Law::template State<double>;

  Driver(const ElementTest& test, const Law& law) : test_(test), law_(law) {
    // The material already moves as the first segment prescribes: Eq. 12 knows no acceleration before the test.
    InitialState initial = test.initial;
    const Vector6 first =
        test.segments.empty() ? Vector6::Zero() : rate_at(completed(test.segments[0]), 0, Vector6::Zero());
    initial.strain_rate = from_soil_sign(first);
    auto state = law.at_rest(initial);
    if (const auto* reason = std::get_if<std::string>(&state))
      throw InputError("the initial state is impossible: " + *reason);
    now_ = {std::get<State>(state), Vector6::Zero(), first, double(Outcome::elastic)};
    // The rates act from the start: with no strain yet, only the rate-dependent part of the stress responds.
    update(now_, Vector6::Zero(), now_.rate, 0);
    now_.outcome = double(Outcome::elastic);
    largest_stress_ = norm(stress(now_));
  }

  ElementResult run() {
    name_columns();
    report(0);
    double start = 0;
    try {
      for (const Segment& asked : test_.segments) {
        const Segment segment = completed(asked);
        run_segment(segment, start);
        start += segment.duration;
      }
    } catch (const RunError& e) {
      result_.failure = e.what();
    }
    return std::move(result_);
  }

 private:
  /// State of the material and its motion; strain and rate compression-positive.
  struct Now {
    State state;
    Vector6 strain, rate;
    double outcome;
  };

  static Vector6 stress_of(const State& state) { return in_soil_sign(Law::total_stress(state)); }
  Vector6 stress(const Now& now) const { return stress_of(now.state); }
  static double norm(const Vector6& s) { return std::sqrt(s.head<3>().squaredNorm() + 2 * s.tail<3>().squaredNorm()); }

  void update(Now& now, const Vector6& strain_increment, const Vector6& rate, double dt) {
    const Motion<double> motion{from_soil_sign(strain_increment), from_soil_sign(rate), dt};
    const Response<double> r = law_.update(now.state, motion, test_.integration);
    ++result_.n_updates;
    result_.n_unconverged += r.outcome == double(Outcome::unconverged);
    now.strain += strain_increment;
    now.rate = rate;
    now.outcome = r.outcome;
  }

  /// What a control of a segment prescribes at an instant.
  double value_at(const Segment& segment, int row, double t) const {
    const Control& c = segment.controls[row];
    const double at_start = start_values_[row], duration = segment.duration;
    if (!segment.history.empty())
      for (int i = 0; i < 6; ++i)
        if (is_strain(c, i)) return at_start + c.of_strain[i] * follow(segment.history, t).strain[i];
    if (c.to_target) return at_start + (c.target - at_start) * (t / duration);
    return at_start + c.rate * t + 0.5 * c.acceleration * t * t;
  }

  void run_segment(const Segment& segment, double start) {
    start_values_ = Vector6::Zero();
    const Vector6 s = stress(now_);
    for (int r = 0; r < 6; ++r)
      for (int i = 0; i < 6; ++i)
        start_values_[r] += segment.controls[r].of_strain[i] * now_.strain[i] + segment.controls[r].of_stress[i] * s[i];
    jacobian_known_ = false;
    std::vector<double> stops = corners(segment);
    for (int row = 1; row <= segment.rows; ++row) stops.push_back(segment.row_time(row));
    std::sort(stops.begin(), stops.end());
    // A user chooses forward_euler to see its error: its steps are the rows.
    const bool one_step =
        straight(segment) && (test_.integration.scheme == Integrator::forward_euler ||
                              (ControlsError<Law> && test_.integration.scheme == Integrator::modified_euler));
    double t = 0, step = segment.row_time(1);
    int next_row = 1;
    for (double stop : stops) {
      if (stop <= t) {
        if (stop < t) continue;
      } else if (one_step) {
        if (!advance(now_, segment, t, stop)) fail(segment, start, t);
        t = stop;
      } else {
        step = advance_with_error_control(segment, start, t, stop, step);
        t = stop;
      }
      largest_stress_ = std::max(largest_stress_, norm(stress(now_)));
      if (next_row <= segment.rows && stop == segment.row_time(next_row)) {
        report(start + stop);
        ++next_row;
      }
    }
  }

  /// From t to `stop` in steps whose error, the difference between one step and two halves, stays below the tolerance.
  /// Returns the length of the next step.
  double advance_with_error_control(const Segment& segment, double start, double t, double stop, double step) {
    const double shortest = 1e-6 * segment.duration;
    // Controlled stresses are met to 1e-9, so smaller errors of steps cannot be resolved.
    const double tolerance = strain_only(segment) ? test_.tolerance : std::max(test_.tolerance, 5e-9);
    while (t < stop) {
      // Two equal steps rather than one and a tiny one.
      const double left = stop - t, end = step >= left ? stop : t + (2 * step > left ? 0.5 * left : step);
      const double middle = 0.5 * (t + end);
      Now whole = now_, halves = now_;
      const bool met = advance(whole, segment, t, end) && advance(halves, segment, t, middle) &&
                       advance(halves, segment, middle, end);
      const double scale = std::max(norm(stress(halves)), 1e-3 * largest_stress_);
      const double error = met ? (scale > 0 ? norm(stress(whole) - stress(halves)) / scale : 0) : 1e30;
      if (error > tolerance && end - t > shortest) {
        step = (end - t) * (met ? std::clamp(0.9 * std::cbrt(tolerance / error), 0.1, 0.7) : 0.25);
        continue;
      }
      if (!met) fail(segment, start, t);
      now_ = halves;
      const double grown = (end - t) * std::clamp(0.9 * std::cbrt(tolerance / std::max(error, 1e-30)), 0.3, 3.0);
      step = end == stop ? std::max(step, grown) : grown;
      t = end;
    }
    return step;
  }

  /// One step. False if the controlled stresses cannot be met.
  bool advance(Now& now, const Segment& segment, double t, double end) {
    if (strain_only(segment)) {
      Matrix6 A;
      Vector6 demand;
      for (int r = 0; r < 6; ++r) {
        for (int i = 0; i < 6; ++i) A(r, i) = segment.controls[r].of_strain[i];
        demand[r] = value_at(segment, r, end);
      }
      const Vector6 strain = A.partialPivLu().solve(demand);
      const Vector6 increment = strain - now.strain;
      update(now, increment, rate_at(segment, end, increment / (end - t)), end - t);
      return true;
    }
    return advance_mixed(now, segment, t, end);
  }

  /// One step under controls of stress, from a state to the end of the step.
  struct MixedStep {
    const Now& from;
    const Segment& segment;
    double end, dt;
    Vector6 demand;  ///< of the controls at the end
    double tight;    ///< error up to which a controlled stress is met [Pa]
  };

  MixedStep mixed_step(const Now& now, const Segment& segment, double t, double end) const {
    MixedStep step{now, segment, end, end - t, {}, 0};
    for (int r = 0; r < 6; ++r) step.demand[r] = value_at(segment, r, end);
    const double stress_scale = std::max(norm(stress(now)), 1e-6 * largest_stress_);
    step.tight = 1e-9 * std::max(stress_scale, 1e-12);
    return step;
  }

  Now moved(const MixedStep& step, const Vector6& increment) {
    Now next = step.from;
    update(next, increment, rate_at(step.segment, step.end, increment / step.dt), step.dt);
    return next;
  }

  /// Difference between the controls and their demand.
  Vector6 residual(const MixedStep& step, const Now& next) const {
    Vector6 r;
    const Vector6 s = stress(next);
    for (int k = 0; k < 6; ++k) {
      r[k] = -step.demand[k];
      for (int i = 0; i < 6; ++i)
        r[k] += step.segment.controls[k].of_strain[i] * next.strain[i] + step.segment.controls[k].of_stress[i] * s[i];
    }
    return r;
  }

  static bool is_stress(const Control& c) {
    return std::any_of(c.of_stress.begin(), c.of_stress.end(), [](double x) { return x != 0; });
  }

  static bool is_met(const MixedStep& step, const Vector6& r) {
    for (int k = 0; k < 6; ++k)
      if (!(std::abs(r[k]) <= (is_stress(step.segment.controls[k]) ? step.tight : 1e-14))) return false;
    return true;
  }

  /// Strain increment of the last rate, except for the strains that are controlled.
  Vector6 first_increment(const MixedStep& step) const {
    Vector6 increment = step.dt * step.from.rate;
    for (int k = 0; k < 6; ++k)
      for (int i = 0; i < 6; ++i)
        if (is_strain(step.segment.controls[k], i))
          increment[i] = step.demand[k] / step.segment.controls[k].of_strain[i] - step.from.strain[i];
    return increment;
  }

  void find_jacobian(const MixedStep& step, const Vector6& increment, const Vector6& r) {
    const double size = std::max(1e-4 * increment.norm(), 1e-9);
    for (int i = 0; i < 6; ++i) {
      Vector6 shifted = increment;
      shifted[i] += size;
      jacobian_.col(i) = (residual(step, moved(step, shifted)) - r) / size;
    }
    jacobian_known_ = true;
  }

  /// Newton's change of the strain increment; none if there is no solution, or only far away.
  std::optional<Vector6> newton_change(const Vector6& increment, const Vector6& r) const {
    // Strain rows are of another size than stress rows.
    Vector6 row_scale = jacobian_.cwiseAbs().rowwise().maxCoeff();
    for (int k = 0; k < 6; ++k)
      if (!(row_scale[k] > 0)) row_scale[k] = 1;
    const Matrix6 scaled = row_scale.cwiseInverse().asDiagonal() * jacobian_;
    const Eigen::FullPivLU<Matrix6> lu(scaled);
    Vector6 change = -lu.solve(row_scale.cwiseInverse().cwiseProduct(r));
    if (!change.allFinite()) return std::nullopt;
    // More strain than this in one step means that the material fails; a shorter step will show.
    const double longest = 0.02, length = (increment + change).norm();
    if (length > longest) {
      if (increment.norm() >= 0.999 * longest) return std::nullopt;
      change = (longest / length) * (increment + change) - increment;
    }
    return change;
  }

  /// Newton's method on the six controls, with a Jacobian from differences that Broyden's update keeps alive.
  bool advance_mixed(Now& now, const Segment& segment, double t, double end) {
    const MixedStep step = mixed_step(now, segment, t, end);
    Vector6 increment = first_increment(step);
    Now next = moved(step, increment);
    Vector6 r = residual(step, next);
    for (int iteration = 0; iteration < 60 && !is_met(step, r); ++iteration) {
      const bool fresh = !jacobian_known_ || (iteration > 0 && iteration % 12 == 0);
      if (fresh) find_jacobian(step, increment, r);
      const std::optional<Vector6> newton = newton_change(increment, r);
      if (!newton) break;
      Vector6 change = *newton;
      const double old = r.norm();
      Now trial = moved(step, increment + change);
      Vector6 trial_r = residual(step, trial);
      for (int cut = 0; cut < 6 && !(trial_r.norm() < 2 * old); ++cut) {
        change *= 0.5;
        trial = moved(step, increment + change);
        trial_r = residual(step, trial);
      }
      const Vector6 predicted = jacobian_ * change;
      if (change.squaredNorm() > 0) jacobian_ += (trial_r - r - predicted) * change.transpose() / change.squaredNorm();
      if (!(trial_r.norm() < 0.9 * old) && !fresh) jacobian_known_ = false;
      increment += change;
      next = trial;
      r = trial_r;
    }
    if (!is_met(step, r)) {
      note_missed_control(segment, r);
      return false;
    }
    now = next;
    return true;
  }

  /// Keeps the controlled stress with the largest error, for the message.
  void note_missed_control(const Segment& segment, const Vector6& r) {
    jacobian_known_ = false;
    worst_ = 0;
    for (int k = 0; k < 6; ++k)
      if (is_stress(segment.controls[k]) && !(std::abs(r[k]) <= std::abs(r[worst_]))) worst_ = k;
    missed_ = r[worst_];
  }

  [[noreturn]] void fail(const Segment& segment, double start, double t) {
    throw RunError(
        fmt::format("the control {} cannot be met at t = {:.6g} s (segment time {:.6g} s of {:.6g} s): {} missing "
                    "in the smallest step. "
                    "The material may have failed or lost its pressure there; control a strain instead, or end the "
                    "segment earlier.",
                    segment.controls[worst_].name, start + t, t, segment.duration,
                    std::isfinite(missed_) ? fmt::format("{:.4g} Pa are", std::abs(missed_)) : "a finite stress is"));
  }

  void name_columns() {
    const auto column = [&](std::string name, std::string unit, std::string meaning) {
      result_.names.push_back(std::move(name));
      result_.units.push_back(std::move(unit));
      result_.meanings.push_back(std::move(meaning));
    };
    const auto tensor = [&](const std::string& name, const std::string& unit, const std::string& meaning) {
      for (const char* c : SymTensor<double>::component_names) column(name + "_" + c, unit, meaning);
    };
    column("time", "s", "time since the start");
    tensor("strain", "1", "strain, compression-positive");
    tensor("strain_rate", "1/s", "strain rate, compression-positive");
    tensor("stress", "Pa", "total stress, compression-positive");
    column("p", "Pa", "mean pressure of the total stress");
    column("q", "Pa", "von Mises stress of the total stress");
    for (const auto& q : Law::quantities()) {
      if (q.components == 6)
        tensor(std::string(q.name), std::string(q.unit), std::string(q.meaning) + ", compression-positive");
      else
        column(std::string(q.name), std::string(q.unit), std::string(q.meaning));
    }
    column("phase", "1", "0 elastic, 1 plastic, 2 at zero pressure, 3 separated, 4 not converged");
  }

  void report(double time) {
    std::vector<double> row{time};
    const auto six = [&](const Vector6& v) { row.insert(row.end(), v.begin(), v.end()); };
    six(now_.strain);
    six(now_.rate);
    six(stress(now_));
    const SymTensor<double> total = Law::total_stress(now_.state);
    row.push_back(pressure(total));
    row.push_back(von_mises(deviator(total)));
    for (const auto& q : Law::quantities()) {
      double v[6];
      q.evaluate(law_, now_.state, from_soil_sign(now_.rate), v);
      if (q.components == 6)
        six(in_soil_sign({v[0], v[1], v[2], v[3], v[4], v[5]}));
      else
        row.push_back(v[0]);
    }
    row.push_back(now_.outcome);
    for (double& value : row) value += 0.0;  // -0 becomes 0
    result_.rows.push_back(std::move(row));
  }

  const ElementTest& test_;
  const Law& law_;
  Now now_;
  Vector6 start_values_;
  Matrix6 jacobian_;
  bool jacobian_known_ = false;
  double largest_stress_ = 0;
  int worst_ = 0;
  double missed_ = 0;
  ElementResult result_;
};

}  // namespace

ElementResult run_element_test(const ElementTest& test) {
  return std::visit([&](const auto& law) { return Driver(test, law).run(); }, test.law);
}

}  // namespace talus
