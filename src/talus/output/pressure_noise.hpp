#pragma once
/// How much pressure rattles: a number of every run.

#include <map>
#include <optional>
#include <span>
#include <vector>

#include "talus/mpm/simulation.hpp"

namespace talus {

/// Noise of the pressure in flow, as shares of the mean pressure there.
struct NoiseShares {
  double in_time;       ///< of the mean pressure in a tile, about its course over a period
  double within_cells;  ///< of the particles' pressures, about the mean of their cell
};

/// Gauges in all places where material flows: tiles of the grid, four cells along each axis, whose material moves at a tenth
/// of sqrt(g h) at least. Over a period of half of sqrt(h/g) a gauge sees 20 pressures; what they differ by from their
/// straight line, and particles at these instants from the mean of their cell, is noise. Shares of a run are over all
/// gauges and periods, weighted with volume.
class PressureNoise {
 public:
  /// Of a run of a case; `so_far` is what `state` gave before it was resumed. Without gravity nothing is gauged.
  explicit PressureNoise(const Case& case_, std::span<const double> so_far = {});

  /// Whether an instant is one at which gauges are read, or the first after one.
  bool due(double time) const { return interval_ > 0 && time >= sums_.next * interval_ * (1 - 1e-12); }
  /// What the gauges read at an instant that is due [s].
  void add(double time, const std::vector<TilePressure>& tiles);

  /// None if nothing has flowed for a period.
  std::optional<NoiseShares> shares() const;
  /// Everything that decides what is to come.
  std::vector<double> state() const;

  static constexpr int readings = 20;  ///< in a period

 private:
  /// Of a run so far; pressures times volumes are of the periods that are over [J].
  struct Sums {
    double next = 0;      ///< number of the reading to come
    double readings = 0;  ///< made in this period
    double start = 0;     ///< of this period [s]
    double pressure = 0, noise = 0, scatter = 0;
  };
  /// Sums over the readings of a gauge in a period, times from its start [s], and volumes as weights of a run's sums.
  struct Gauge {
    double n = 0, t = 0, tt = 0, p = 0, tp = 0, pp = 0, volume = 0, scatter = 0, speed2 = 0;
  };
  void end_period();

  double interval_ = 0;        ///< between readings [s]
  double least_speed_ = 0;     ///< of what flows [m/s]
  double least_pressure_ = 0;  ///< of material that carries something; the rest is rounding [Pa]
  Sums sums_;
  std::map<Index<3>, Gauge> gauges_;
};

}  // namespace talus
