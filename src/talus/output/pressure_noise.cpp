#include "talus/output/pressure_noise.hpp"

#include <algorithm>
#include <cmath>

#include "talus/base/image.hpp"

namespace talus {

PressureNoise::PressureNoise(const Case& case_, std::span<const double> so_far) {
  const double g = std::sqrt(dot(case_.gravity, case_.gravity));
  if (!(g > 0)) return;
  interval_ = 0.5 * std::sqrt(case_.cell / g) / readings;
  least_speed_ = 0.1 * std::sqrt(case_.cell * g);
  constexpr double density = 1000;  // about that of ground [kg/m3]
  least_pressure_ = 1e-6 * density * g * case_.cell;
  if (so_far.empty()) return;
  const auto next = [&](std::size_t n) {
    std::vector<double> row(so_far.begin(), so_far.begin() + std::ptrdiff_t(n));
    so_far = so_far.subspan(n);
    return row;
  };
  set_from_image(sums_, next(sizeof(Sums) / sizeof(double)));
  while (!so_far.empty()) {
    const std::vector<double> tile = next(3);
    set_from_image(gauges_[{int(tile[0]), int(tile[1]), int(tile[2])}], next(sizeof(Gauge) / sizeof(double)));
  }
}

std::vector<double> PressureNoise::state() const {
  std::vector<double> all = image_of(sums_);
  for (const auto& [tile, gauge] : gauges_) {
    all.insert(all.end(), tile.begin(), tile.end());
    const std::vector<double> row = image_of(gauge);
    all.insert(all.end(), row.begin(), row.end());
  }
  return all;
}

void PressureNoise::add(double time, const std::vector<TilePressure>& tiles) {
  if (sums_.readings == 0) sums_.start = time;
  const double t = time - sums_.start;
  for (const TilePressure& seen : tiles) {
    Gauge& g = gauges_[seen.tile];
    g.n += 1;
    g.t += t;
    g.tt += t * t;
    g.p += seen.pressure;
    g.tp += t * seen.pressure;
    g.pp += seen.pressure * seen.pressure;
    g.volume += seen.volume;
    g.scatter += seen.scatter;
    g.speed2 += seen.speed * seen.speed;
  }
  sums_.next = std::floor(time / interval_ * (1 + 1e-12)) + 1;
  sums_.readings += 1;
  if (sums_.readings == readings) end_period();
}

/// Of gauges that were in the material all the period, and saw pressure.
void PressureNoise::end_period() {
  for (const auto& [tile, g] : gauges_) {
    if (g.n < readings || !(g.speed2 / g.n >= least_speed_ * least_speed_)) continue;
    if (!(g.p / g.n > least_pressure_)) continue;
    const double tt = g.tt - g.t * g.t / g.n, tp = g.tp - g.t * g.p / g.n, pp = g.pp - g.p * g.p / g.n;
    const double about_line = std::max(0.0, pp - tp * tp / tt) / (g.n - 2), volume = g.volume / g.n;
    sums_.noise += volume * std::sqrt(about_line);
    sums_.pressure += volume * g.p / g.n;
    sums_.scatter += volume * g.scatter / g.n;
  }
  gauges_.clear();
  sums_.readings = 0;
}

std::optional<NoiseShares> PressureNoise::shares() const {
  if (!(sums_.pressure > 0)) return std::nullopt;
  return NoiseShares{sums_.noise / sums_.pressure, sums_.scatter / sums_.pressure};
}

}  // namespace talus
