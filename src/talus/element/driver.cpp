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

  Driver(const ElementTest& test, const Law& law, long most_updates)
      : test_(test), law_(law), most_updates_(most_updates) {
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
    double start = 0;
    std::optional<int> ended;  // the loop that a stop has ended
    pore_at_start_ = test_.pore_pressure;
    if (!test_.segments.empty()) laboratory_ = test_.segments[0].laboratory;
    laboratory_.undrained = false;
    try {
      report(0);
      for (const Segment& asked : test_.segments) {
        if (ended == asked.group) continue;
        const Segment segment = completed(asked);
        const End end = run_segment(segment, start);
        start += end.time;
        if (end.stop && !end.stop->turns) ended = segment.group;
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

  /// Shortest step, as a share of the segment: the resolution of time, because the response time of the material is
  /// independent of the length of the segment.
  static constexpr double least_step = 1e-12;
  /// Largest strain in a step; a larger one means that the material may fail, and the step is shortened.
  static constexpr double longest_strain = 0.02;
  static constexpr double longest_strain_at_once = 0.5;
  /// Share of the segment below which a step that Newton's method cannot solve is solved by a search.
  static constexpr double step_of_search = 1e-6;

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

  /// How a segment ended: after its duration, or at a stop.
  struct End {
    double time;
    const Stop* stop = nullptr;
  };

  End run_segment(const Segment& segment, double start) {
    laboratory_ = segment.laboratory;
    held_at_start_ = held_in_undrained(stress(now_));
    start_values_ = Vector6::Zero();
    const Vector6 s = stress(now_);
    for (int r = 0; r < 6; ++r)
      for (int i = 0; i < 6; ++i)
        start_values_[r] += segment.controls[r].of_strain[i] * now_.strain[i] + segment.controls[r].of_stress[i] * s[i];
    jacobian_known_ = false;
    const End end = segment.stops.empty() ? End{segment.duration} : find_end(segment, start);
    const auto row_time = [&](int row) {
      return row == segment.rows ? end.time : segment.row_time(row) * (end.time / segment.duration);
    };
    std::vector<double> stops = corners(segment);
    std::erase_if(stops, [&](double t) { return t > end.time; });
    for (int row = 1; row <= segment.rows && end.time > 0; ++row) stops.push_back(row_time(row));
    std::sort(stops.begin(), stops.end());
    const bool one_step = takes_one_step(segment);
    double t = 0, step = row_time(1);
    int next_row = 1;
    for (double stop : stops) {
      // An instant of a table and a row may differ in their last digits; no step fits between them.
      if (stop - t <= 1e-12 * stop) {
        if (stop < t) continue;
      } else if (one_step) {
        if (!advance(now_, segment, t, stop)) fail(segment, start, t);
        t = stop;
      } else {
        step = advance_with_error_control(segment, start, t, stop, step);
        t = stop;
      }
      largest_stress_ = std::max(largest_stress_, norm(stress(now_)));
      if (next_row <= segment.rows && stop == row_time(next_row)) {
        report(start + stop);
        ++next_row;
      }
    }
    pore_at_start_ = pore_pressure(now_);
    if (!end.stop)
      for (const Stop& turn : segment.stops)
        if (turn.turns)
          throw RunError(
              fmt::format("the turning point {:.4g} Pa of a cycle is not reached at t = {:.6g} s, after the "
                          "longest way. The material may have failed; choose a smaller amplitude, or a `stop`.",
                          turn.value, start + end.time));
    return end;
  }

  /// A user chooses forward_euler to see its error: its steps are the rows.
  bool takes_one_step(const Segment& segment) const {
    return straight(segment) && (test_.integration.scheme == Integrator::forward_euler ||
                                 (ControlsError<Law> && test_.integration.scheme == Integrator::modified_euler));
  }

  // ---- laboratory quantities --------------------------------------------------------------------------------

  double lateral_stress(const Vector6& s) const { return 0.5 * (s.head<3>().sum() - s[laboratory_.axis]); }
  /// The effective stress whose total is held in an undrained test.
  double held_in_undrained(const Vector6& s) const {
    return laboratory_.plane < 0 ? lateral_stress(s) : s[laboratory_.axis];
  }
  double pore_pressure(const Now& now) const {
    return laboratory_.undrained ? pore_at_start_ + held_at_start_ - held_in_undrained(stress(now)) : pore_at_start_;
  }
  /// Von Mises stress with the sign of axial less lateral stress, or of the shear stress in a plane of shear.
  double signed_q(const Now& now) const {
    const Vector6 s = stress(now);
    const double sign = laboratory_.plane < 0 ? s[laboratory_.axis] - lateral_stress(s) : s[3 + laboratory_.plane];
    return std::copysign(von_mises(deviator(Law::total_stress(now.state))), sign);
  }
  double measure(const Now& now, Measure what) const {
    const double p = pressure(Law::total_stress(now.state));
    const int shear = 3 + std::max(laboratory_.plane, 0);
    switch (what) {
      case Measure::p: return p;
      case Measure::q: return signed_q(now);
      case Measure::eta: return p > 0 ? signed_q(now) / p : 0;
      case Measure::axial_strain: return now.strain[laboratory_.axis];
      case Measure::volumetric_strain: return now.strain.template head<3>().sum();
      case Measure::shear_strain: return now.strain[shear];
      case Measure::axial_stress: return stress(now)[laboratory_.axis];
      case Measure::shear_stress: return stress(now)[shear];
      case Measure::pore_pressure: return pore_pressure(now);
    }
    return 0;
  }

  // ---- stops -----------------------------------------------------------------------------------------------------

  /// Distance of a state from a stop, positive before it; a stop without direction is approached from the side of the
  /// start of the segment.
  struct Approach {
    const Stop* stop;
    double side, scale;
  };
  /// The stop that is nearest, and its distance relative to its value.
  struct Nearest {
    const Stop* stop = nullptr;
    double distance = 1e300;
  };
  Nearest nearest_stop(std::vector<Approach>& approaches, const Now& now) const {
    Nearest nearest;
    for (Approach& a : approaches) {
      const double left = a.stop->value - measure(now, a.stop->measure);
      if (a.side == 0 && left != 0) a.side = left > 0 ? 1 : -1;
      if (a.side != 0 && a.side * left / a.scale < nearest.distance) nearest = {a.stop, a.side * left / a.scale};
    }
    return nearest;
  }

  /// Where the first stop is reached, found by running the segment in steps that grow and shrink with the distance to
  /// it; the state stays at the start.
  End find_end(const Segment& segment, double start) {
    std::vector<Approach> approaches;
    for (const Stop& stop : segment.stops) {
      const double size = std::max(std::abs(stop.value), std::abs(measure(now_, stop.measure)));
      approaches.push_back({&stop, double(stop.direction), size > 0 ? size : 1});
    }
    Nearest nearest = nearest_stop(approaches, now_);
    if (nearest.distance <= 0) return {0, nearest.stop};
    const Now at_start = now_;
    std::vector<double> turns = corners(segment);
    turns.push_back(segment.duration);
    const bool one_step = takes_one_step(segment);
    const auto move = [&](double from, double to) {
      if (one_step)
        advance(now_, segment, from, to);
      else
        advance_with_error_control(segment, start, from, to, to - from);
    };
    End end{segment.duration};
    try {
      double t = 0, step = 1e-6 * segment.duration;
      while (t < segment.duration && !end.stop) {
        const double to = std::min(t + step, *std::upper_bound(turns.begin(), turns.end(), t));
        const Now before = now_;
        move(t, to);
        const Nearest next = nearest_stop(approaches, now_);
        if (next.distance <= 0) {
          end = end_between(approaches, before, t, to, nearest.distance, next, move);
          break;
        }
        const double change = std::abs(next.distance - nearest.distance) / nearest.distance;
        step = std::min(step * (change > 0.5 ? 0.5 : change < 0.1 ? 2 : 1), segment.duration / 200);
        nearest = next;
        t = to;
      }
    } catch (const RunError&) {
      end = {segment.duration};  // the segment itself will fail, with its rows
    }
    now_ = at_start;
    jacobian_known_ = false;
    return end;
  }

  /// Where a stop is reached between two instants, by regula falsi within bounds.
  End end_between(std::vector<Approach>& approaches, const Now& before, double from, double to, double d_from,
                  Nearest reached, const auto& move) {
    double low = from, high = to, d_low = d_from;
    for (int i = 0; i < 60 && high - low > 1e-13 * to && std::abs(reached.distance) > 1e-12; ++i) {
      const double share = std::clamp(d_low / (d_low - reached.distance), 0.01, 0.99);
      const double middle = i % 3 == 2 ? 0.5 * (low + high) : low + share * (high - low);
      now_ = before;
      move(from, middle);
      const Nearest here = nearest_stop(approaches, now_);
      if (here.distance <= 0) {
        high = middle;
        reached = here;
      } else {
        low = middle;
        d_low = here.distance;
      }
    }
    return {high, reached.stop};
  }

  // ---- steps -----------------------------------------------------------------------------------------------------

  /// From t to `stop` in steps whose error, the difference between one step and two halves, stays below the tolerance.
  /// Returns the length of the next step.
  double advance_with_error_control(const Segment& segment, double start, double t, double stop, double step) {
    // Controlled stresses are met to 1e-9, so smaller errors of steps cannot be resolved.
    const double tolerance = strain_only(segment) ? test_.tolerance : std::max(test_.tolerance, 5e-9);
    while (t < stop) {
      if (result_.n_updates > most_updates_)
        throw RunError(fmt::format("more than {} updates of the law are needed; the test ends at t = {:.6g} s",
                                   most_updates_, start + t));
      // Two equal steps rather than one and a tiny one.
      const double left = stop - t, end = step >= left ? stop : t + (2 * step > left ? 0.5 * left : step);
      const double middle = 0.5 * (t + end);
      Now whole = now_, halves = now_;
      const bool met = advance(whole, segment, t, end) && advance(halves, segment, t, middle) &&
                       advance(halves, segment, middle, end);
      const double scale = std::max(norm(stress(halves)), 1e-3 * largest_stress_);
      const double error = met ? (scale > 0 ? norm(stress(whole) - stress(halves)) / scale : 0) : 1e30;
      const double strain = norm(halves.strain - now_.strain);
      if (!(error <= tolerance) &&
          end - t > (met ? least_controlled(segment, strain, end - t) : least_step * segment.duration)) {
        step = (end - t) * (met ? std::clamp(0.9 * std::cbrt(tolerance / error), 0.1, 0.7) : 0.25);
        continue;
      }
      if (!met) {
        if (t == 0 && respond_at_once(segment)) {
          step = segment.row_time(1);
          continue;
        }
        fail(segment, start, t);
      }
      now_ = halves;
      const double grown = (end - t) * std::clamp(0.9 * std::cbrt(tolerance / std::max(error, 1e-30)), 0.3, 3.0);
      step = end == stop ? std::max(step, grown) : grown;
      t = end;
    }
    return step;
  }

  /// Length of a step below which its error is accepted: at a kink of the response no step is short enough. A step with
  /// a noticeable strain is not accepted this way, for any length of the segment.
  static double least_controlled(const Segment& segment, double strain, double length) {
    constexpr double noticeable = 1e-4;
    return strain > noticeable ? std::min(step_of_search * segment.duration, 0.5 * length)
                               : step_of_search * segment.duration;
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
    double end, dt;  ///< a step of no duration: the rates of free strains stay what they were
    Vector6 demand;  ///< of the controls at the end
    double tight;    ///< error up to which a controlled stress is met [Pa]
    double loose;  ///< the same where the response has jumps, by the substeps of a law, that are as large as this [Pa]
  };

  MixedStep mixed_step(const Now& now, const Segment& segment, double t, double end) const {
    MixedStep step{now, segment, end, end - t, {}, 0, 0};
    for (int r = 0; r < 6; ++r) step.demand[r] = value_at(segment, r, end);
    const double stress_scale = std::max(norm(stress(now)), 1e-6 * largest_stress_);
    step.tight = 1e-9 * std::max(stress_scale, 1e-12);
    step.loose = std::max(step.tight, 1e-2 * test_.tolerance * stress_scale);
    return step;
  }

  Now moved(const MixedStep& step, const Vector6& increment) {
    Now next = step.from;
    const Vector6 free_rate = step.dt > 0 ? Vector6(increment / step.dt) : step.from.rate;
    update(next, increment, rate_at(step.segment, step.end, free_rate), step.dt);
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

  static bool is_met(const MixedStep& step, const Vector6& r, double error_of_stress) {
    for (int k = 0; k < 6; ++k)
      if (!(std::abs(r[k]) <= (is_stress(step.segment.controls[k]) ? error_of_stress : 1e-14))) return false;
    return true;
  }
  static bool is_met(const MixedStep& step, const Vector6& r) { return is_met(step, r, step.tight); }

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

  /// Newton's change of the strain increment; none if there is no solution within the largest strain.
  std::optional<Vector6> newton_change(const Vector6& increment, const Vector6& r) const {
    // Strain rows and stress rows have different magnitudes.
    Vector6 row_scale = jacobian_.cwiseAbs().rowwise().maxCoeff();
    for (int k = 0; k < 6; ++k)
      if (!(row_scale[k] > 0)) row_scale[k] = 1;
    const Matrix6 scaled = row_scale.cwiseInverse().asDiagonal() * jacobian_;
    const Eigen::FullPivLU<Matrix6> lu(scaled);
    Vector6 change = -lu.solve(row_scale.cwiseInverse().cwiseProduct(r));
    if (!change.allFinite()) return std::nullopt;
    const double length = (increment + change).norm();
    if (length > longest_strain) {
      if (increment.norm() >= 0.999 * longest_strain) return std::nullopt;
      change = (longest_strain / length) * (increment + change) - increment;
    }
    return change;
  }

  /// Newton's method on the six controls, with a Jacobian from differences and Broyden's update.
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
      note_missed_control(segment, next, r);
      return end - t <= step_of_search * segment.duration && advance_by_search(now, step);
    }
    now = next;
    return true;
  }

  /// If prescribed rates jump at the start of a segment, the collisional stress jumps too. Under a constant stress,
  /// contacts must gain or lose the difference at once, by a strain without duration: over a short step it would be a
  /// rate whose collisional stress exceeds the total. False if no rate jumps, or there is no such strain.
  bool respond_at_once(const Segment& segment) {
    if (strain_only(segment) || rate_at(segment, 0, now_.rate) == now_.rate) return false;
    Now next = now_;
    if (!advance_by_search(next, mixed_step(now_, segment, 0, 0))) return false;
    now_ = next;
    return true;
  }

  /// Repeats a short step in which Newton's method has failed, because the response has kinks where contacts are lost
  /// or a rate jumps: by bracketing, or by steps that only decrease the residual.
  bool advance_by_search(Now& now, const MixedStep& step) {
    std::optional<Now> found = advance_by_bracket(step);
    if (!found) found = advance_downhill(step);
    if (found) now = *found;
    return found.has_value();
  }

  /// The only strain component that is not controlled on its own, and the control that takes its place.
  struct FreeStrain {
    int component, control;
  };
  static std::optional<FreeStrain> only_free_strain(const Segment& segment) {
    std::optional<FreeStrain> free;
    for (int i = 0; i < 6; ++i) {
      const auto single = [&](const Control& c) { return is_strain(c, i); };
      if (std::any_of(segment.controls.begin(), segment.controls.end(), single)) continue;
      if (free) return std::nullopt;
      free = FreeStrain{i, 0};
    }
    for (int k = 0; k < 6 && free; ++k)
      if (is_stress(segment.controls[k])) free->control = k;
    return free;
  }

  /// With one free strain: the root nearest to the strain of the last rate, from a change of sign.
  std::optional<Now> advance_by_bracket(const MixedStep& step) {
    const std::optional<FreeStrain> free = only_free_strain(step.segment);
    if (!free) return std::nullopt;
    Vector6 increment = first_increment(step);
    const double start = increment[free->component];
    Now next = step.from;
    const auto residual_at = [&](double strain) {
      increment[free->component] = strain;
      next = moved(step, increment);
      return residual(step, next)[free->control];
    };
    struct Point {
      double x, r;
    };
    Point low{start, residual_at(start)}, high = low;
    const auto bracketed = [&] { return (low.r < 0) != (high.r < 0); };
    Point a = low, b = low;
    for (double away = std::max(1e-3 * increment.norm(), 1e-13); !bracketed(); away *= 2) {
      if (!(away < (step.dt > 0 ? longest_strain : longest_strain_at_once))) return std::nullopt;
      const Point below{start - away, residual_at(start - away)}, above{start + away, residual_at(start + away)};
      if ((below.r < 0) != (low.r < 0)) {
        a = below, b = low;
        break;
      }
      if ((above.r < 0) != (high.r < 0)) {
        a = high, b = above;
        break;
      }
      low = below, high = above;
    }
    // Regula falsi (Illinois), with a bisection where it does not halve the bracket in three steps.
    double wide = b.x - a.x;
    int side = 0;
    for (int i = 0; i < 400; ++i) {
      double x = a.x - a.r * (b.x - a.x) / (b.r - a.r);
      if (i % 3 == 2 && b.x - a.x > 0.5 * wide) x = 0.5 * (a.x + b.x);
      if (i % 3 == 2) wide = b.x - a.x;
      const bool resolved = x > a.x && x < b.x;
      if (!resolved) x = 0.5 * (a.x + b.x);
      const double r = residual_at(x);
      if (std::abs(r) <= step.tight) return next;
      const bool last = !(x > a.x && x < b.x) || b.x - a.x < 1e-20;  // the bracket cannot shrink further
      if (last) {
        if (std::abs(r) <= step.loose) return next;
        for (const Point& end : {a, b}) {  // the stress jumps here
          residual_at(end.x);
          separated_ = separated_ || carries_nothing(next);
        }
        return std::nullopt;
      }
      if ((r < 0) == (a.r < 0)) {
        a = {x, r};
        if (side < 0) b.r *= 0.5;
        side = -1;
      } else {
        b = {x, r};
        if (side > 0) a.r *= 0.5;
        side = 1;
      }
    }
    return std::nullopt;
  }

  /// Newton's method with a new Jacobian in every iteration, whose changes are cut until the residual decreases.
  std::optional<Now> advance_downhill(const MixedStep& step) {
    Vector6 increment = first_increment(step);
    Now next = moved(step, increment);
    Vector6 r = residual(step, next);
    for (int iteration = 0; iteration < 40 && !is_met(step, r); ++iteration) {
      find_jacobian(step, increment, r);
      const std::optional<Vector6> newton = newton_change(increment, r);
      if (!newton) break;
      Vector6 change = *newton;
      bool lower = false;
      for (int cut = 0; cut < 30 && !lower; ++cut, change *= 0.5) {
        const Now trial = moved(step, increment + change);
        const Vector6 trial_r = residual(step, trial);
        lower = trial_r.norm() < r.norm();
        if (!lower) continue;
        increment += change;
        next = trial;
        r = trial_r;
      }
      if (!lower) break;
    }
    jacobian_known_ = false;
    return is_met(step, r, step.loose) ? std::optional<Now>(next) : std::nullopt;
  }

  bool carries_nothing(const Now& now) const {
    return now.outcome == double(Outcome::separated) && norm(stress(now)) == 0;
  }

  /// Stores the controlled stress with the largest error, for the message.
  void note_missed_control(const Segment& segment, const Now& next, const Vector6& r) {
    jacobian_known_ = false;
    separated_ = carries_nothing(next);
    worst_ = 0;
    for (int k = 0; k < 6; ++k)
      if (is_stress(segment.controls[k]) && !(std::abs(r[k]) <= std::abs(r[worst_]))) worst_ = k;
    missed_ = r[worst_];
  }

  [[noreturn]] void fail(const Segment& segment, double start, double t) {
    std::string_view advice =
        separated_ ? "The grains separate there, and the law carries no stress across the gap between them."
                   : "The material may have failed or lost its pressure there; control a strain instead, or end the "
                     "segment earlier.";
    if constexpr (RemembersStrainRate<Law>) {
      // Eq. 12 has no solution beyond a fold: docs/theory/collisional_stress.md, Sec. 5.
      if (!separated_ && now_.outcome == double(Outcome::separated))
        advice =
            "Collisions alone carry the stress there, by dilation that grows with the shear rate, up to about 1.04 "
            "(collisional_form = \"incremental\") or 1.16 (\"rate\") times the shear rate at which contacts lose their "
            "pressure. Use collisional_form = \"total\", or lower shear rates.";
    }
    throw RunError(fmt::format(
        "the control {} cannot be met at t = {:.6g} s (segment time {:.6g} s of {:.6g} s): {} missing "
        "in the smallest step. {}",
        segment.controls[worst_].name, start + t, t, segment.duration,
        std::isfinite(missed_) ? fmt::format("{:.4g} Pa are", std::abs(missed_)) : "a finite stress is", advice));
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
    column("axial_strain", "%", "strain along the axis of the test");
    column("volumetric_strain", "%", "volumetric strain, compression-positive");
    column("q_signed", "Pa", "q with the sign of axial less lateral stress, or of the shear stress in simple shear");
    column("eta", "1", "q_signed/p; 0 without pressure");
    column("pore_pressure", "Pa", "pore pressure where the lateral (in simple shear: normal) total stress is held");
    for (const auto& q : Law::quantities()) {
      if (q.components == 6)
        tensor(std::string(q.name), std::string(q.unit), std::string(q.meaning) + ", compression-positive");
      else
        column(std::string(q.name), std::string(q.unit), std::string(q.meaning));
    }
    column("phase", "1", "0 elastic, 1 plastic, 2 at zero pressure, 3 separated, 4 not converged");
  }

  void report(double time) {
    if (!now_.strain.allFinite() || !stress(now_).allFinite())
      throw RunError(fmt::format(
          "the stress is not finite at t = {:.6g} s; a parameter, a stress or a strain is too large", time));
    std::vector<double> row{time};
    const auto six = [&](const Vector6& v) { row.insert(row.end(), v.begin(), v.end()); };
    six(now_.strain);
    six(now_.rate);
    six(stress(now_));
    const SymTensor<double> total = Law::total_stress(now_.state);
    row.push_back(pressure(total));
    row.push_back(von_mises(deviator(total)));
    row.push_back(100 * measure(now_, Measure::axial_strain));
    row.push_back(100 * measure(now_, Measure::volumetric_strain));
    row.push_back(signed_q(now_));
    row.push_back(measure(now_, Measure::eta));
    row.push_back(pore_pressure(now_));
    for (const auto& q : Law::quantities()) {
      double v[6];
      q.evaluate(law_, now_.state, from_soil_sign(now_.rate), v);
      if (q.components == 6)
        six(in_soil_sign({v[0], v[1], v[2], v[3], v[4], v[5]}));
      else
        row.push_back(v[0]);
    }
    row.push_back(now_.outcome);
    if constexpr (MayReturnWork<Law>)
      result_.n_returning +=
          collisional_dissipation(Law::collisional_stress(now_.state), from_soil_sign(now_.rate)) < 0;
    for (double& value : row) value += 0.0;  // -0 becomes 0
    result_.rows.push_back(std::move(row));
  }

  const ElementTest& test_;
  const Law& law_;
  long most_updates_;
  Now now_;
  Vector6 start_values_;
  Laboratory laboratory_;
  double pore_at_start_ = 0, held_at_start_ = 0;  ///< pore pressure, and effective stress whose total is held [Pa]
  Matrix6 jacobian_;
  bool jacobian_known_ = false;
  double largest_stress_ = 0;
  int worst_ = 0;
  double missed_ = 0;
  bool separated_ = false;  ///< whether the material carried no stress where the control was missed
  ElementResult result_;
};

}  // namespace

ElementResult run_element_test(const ElementTest& test, long most_updates) {
  return std::visit([&](const auto& law) { return Driver(test, law, most_updates).run(); }, test.law);
}

}  // namespace talus
