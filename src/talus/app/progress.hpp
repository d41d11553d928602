#pragma once
/// Progress of a run: one live line on a terminal, a line now and then in a log.

#include <chrono>
#include <string>

#include "talus/mpm/simulation.hpp"

namespace talus {

class Progress {
 public:
  /// For a run that goes from where the ledger stands to the time `end` [s].
  Progress(double end, const Ledger& from);
  /// To be called every step; prints when the last line is old enough.
  void show(const Ledger& ledger, long n_particles);
  /// Ends the live line.
  void finish(const Ledger& ledger, long n_particles);
  double seconds() const;

 private:
  std::string line(const Ledger& ledger, long n_particles) const;
  /// What fits into the line of a terminal, so that it is overwritten by the next.
  std::string live_line(const Ledger& ledger, long n_particles) const;
  /// Million particle-steps a second.
  double speed(const Ledger& ledger, long n_particles) const;

  double end_, from_time_;
  long from_step_;
  bool live_;
  std::chrono::steady_clock::time_point start_, last_shown_;
};

/// 75 -> "1:15 min", 7200 -> "2:00 h".
std::string duration_in_words(double seconds);

}  // namespace talus
