#include "talus/output/pressure_noise.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

namespace {

constexpr std::size_t n_numbers = 6, n_of_gauge = 12;

}  // namespace

PressureNoise::PressureNoise(const Case& case_, std::span<const double> so_far) {
  const double g = std::sqrt(dot(case_.gravity, case_.gravity));
  if (!(g > 0)) return;
  interval_ = 0.5 * std::sqrt(case_.cell / g) / readings;
  least_speed_ = 0.1 * std::sqrt(case_.cell * g);
  if (so_far.size() < n_numbers) return;
  next_ = so_far[0];
  readings_made_ = so_far[1];
  start_ = so_far[2];
  pressure_ = so_far[3];
  noise_ = so_far[4];
  scatter_ = so_far[5];
  for (auto row = so_far.subspan(n_numbers); row.size() >= n_of_gauge; row = row.subspan(n_of_gauge))
    gauges_[{int(row[0]), int(row[1]), int(row[2])}] = {row[3], row[4], row[5],  row[6], row[7],
                                                        row[8], row[9], row[10], row[11]};
}

std::vector<double> PressureNoise::state() const {
  std::vector<double> all{next_, readings_made_, start_, pressure_, noise_, scatter_};
  for (const auto& [tile, g] : gauges_)
    all.insert(all.end(), {double(tile[0]), double(tile[1]), double(tile[2]), g.n, g.t, g.tt, g.p, g.tp, g.pp, g.volume,
                           g.scatter, g.speed2});
  return all;
}

void PressureNoise::add(double time, const std::vector<TilePressure>& tiles) {
  if (readings_made_ == 0) start_ = time;
  const double t = time - start_;
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
  next_ = std::floor(time / interval_ * (1 + 1e-12)) + 1;
  readings_made_ += 1;
  if (readings_made_ == readings) end_period();
}

/// Of gauges that were in the material all the period.
void PressureNoise::end_period() {
  for (const auto& [tile, g] : gauges_) {
    if (g.n < readings || !(g.speed2 / g.n >= least_speed_ * least_speed_)) continue;
    const double tt = g.tt - g.t * g.t / g.n, tp = g.tp - g.t * g.p / g.n, pp = g.pp - g.p * g.p / g.n;
    const double about_line = std::max(0.0, pp - tp * tp / tt) / (g.n - 2), volume = g.volume / g.n;
    noise_ += volume * std::sqrt(about_line);
    pressure_ += volume * g.p / g.n;
    scatter_ += volume * g.scatter / g.n;
  }
  gauges_.clear();
  readings_made_ = 0;
}

std::optional<NoiseShares> PressureNoise::shares() const {
  if (!(pressure_ > 0)) return std::nullopt;
  return NoiseShares{noise_ / pressure_, scatter_ / pressure_};
}

}  // namespace talus
