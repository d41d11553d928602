#include "talus/element/segment.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

TableMotion follow(const std::vector<RateInstant>& table, double t) {
  const auto row = [&](std::size_t i) { return Vector6(table[i].rate.data()); };
  TableMotion m{row(0), Vector6::Zero()};
  for (std::size_t i = 1; i < table.size(); ++i) {
    const double t0 = table[i - 1].time, t1 = std::min(t, table[i].time);
    if (t1 <= t0) break;
    const double share = (t1 - t0) / (table[i].time - t0);
    m.rate = row(i - 1) + share * (row(i) - row(i - 1));
    m.strain += 0.5 * (t1 - t0) * (row(i - 1) + m.rate);
  }
  return m;
}

bool strain_only(const Segment& segment) { return !controls_a_stress(segment); }

bool straight(const Segment& segment) {
  if (!segment.history.empty() || !strain_only(segment)) return false;
  // rate and acceleration of all controls are parallel
  for (const Control& a : segment.controls)
    for (const Control& b : segment.controls)
      if (std::abs(a.rate * b.acceleration - b.rate * a.acceleration) > 1e-14 * std::abs(a.rate * b.acceleration))
        return false;
  return true;
}

std::vector<double> corners(const Segment& segment) {
  std::vector<double> times;
  for (std::size_t r = 0; r < segment.history.size(); ++r) {
    const RateInstant& b = segment.history[r];
    times.push_back(b.time);
    if (r == 0) continue;
    const RateInstant& a = segment.history[r - 1];
    for (int i = 0; i < 6; ++i)
      if (a.rate[i] * b.rate[i] < 0) times.push_back(a.time + (b.time - a.time) * a.rate[i] / (a.rate[i] - b.rate[i]));
  }
  if (segment.history.empty())
    for (const Control& c : segment.controls)
      if (!c.to_target && c.acceleration != 0) times.push_back(-c.rate / c.acceleration);
  std::erase_if(times, [&](double t) { return !(t > 0 && t < segment.duration); });
  std::sort(times.begin(), times.end());
  times.erase(std::unique(times.begin(), times.end()), times.end());
  return times;
}

bool is_strain(const Control& c, int component) {
  for (int i = 0; i < 6; ++i)
    if (c.of_stress[i] != 0 || (i != component && c.of_strain[i] != 0)) return false;
  return c.of_strain[component] != 0;
}

Vector6 rate_at(const Segment& segment, double t, const Vector6& otherwise) {
  const Vector6 of_table = segment.history.empty() ? Vector6::Zero() : follow(segment.history, t).rate;
  Vector6 rate = otherwise;
  // A control of a single strain component prescribes its rate.
  for (const Control& c : segment.controls)
    for (int i = 0; i < 6; ++i)
      if (is_strain(c, i))
        rate[i] = segment.history.empty() ? (c.rate + c.acceleration * t) / c.of_strain[i] : of_table[i];
  return rate;
}

Segment completed(Segment segment) {
  for (int i = 0; i < 6; ++i) {
    Control& c = segment.controls[i];
    const auto zero = [](double x) { return x == 0; };
    if (std::all_of(c.of_strain.begin(), c.of_strain.end(), zero) &&
        std::all_of(c.of_stress.begin(), c.of_stress.end(), zero))
      c.of_strain[i] = 1;
  }
  return segment;
}

}  // namespace talus
