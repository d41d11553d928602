#pragma once
/// Output of a run: histories, snapshots, pictures, checkpoints.

#include <chrono>
#include <optional>
#include <string>
#include <vector>

#include "talus/app/task.hpp"
#include "talus/mpm/simulation.hpp"
#include "talus/output/checkpoint.hpp"
#include "talus/output/gauges.hpp"
#include "talus/output/history.hpp"
#include "talus/output/outline.hpp"
#include "talus/output/picture.hpp"
#include "talus/output/pressure_noise.hpp"
#include "talus/output/snapshot.hpp"
#include "talus/output/surface_forces.hpp"
#include "talus/output/terrain_maps.hpp"

namespace talus {

/// Time that a run has used, with that before it was resumed.
class RunClock {
 public:
  RunClock(double wall_before, double cpu_before);
  /// Time on the clock [s].
  double wall_seconds() const;
  /// Processor time of all threads [s].
  double cpu_seconds() const;

 private:
  std::chrono::steady_clock::time_point start_;
  double wall_before_, cpu_before_;
};

/// Writes rows of history.csv, surface.csv and rings.csv, snapshots, instants of pictures and checkpoints, each when it is due.
class Recorder {
 public:
  /// Starts the files of a new run, with a first checkpoint; or continues those of the run that the task resumes.
  Recorder(const Task& task, RunSoFar so_far, const OutlineFinder& outlines, const Simulation& simulation);

  /// Writes what is due at this instant, once; at the end of the run a row and a snapshot whether they are due or not.
  void record(Simulation& simulation, bool is_end);

  /// Whether the simulated time or the time on the clock asks for a checkpoint now.
  bool checkpoint_is_due(const Simulation& simulation);
  /// Writes a checkpoint after everything it depends on: all that was written before it.
  void write_checkpoint(const Simulation& simulation);
  /// The last checkpoint.
  std::string last_checkpoint() const { return checkpoints_.last(); }

  const RunSoFar& so_far() const { return so_far_; }
  const RunClock& clock() const { return clock_; }
  const History& history() const { return history_; }
  const PictureBook& pictures() const { return pictures_; }
  const PressureNoise& noise() const { return noise_; }
  const SurfaceForces& forces() const { return forces_; }
  TerrainMaps& maps() { return maps_; }
  const Gauges& gauges() const { return gauges_; }
  /// Whether kinetic energy has been below `stop_below` of its peak for the time in which a body falls by the height of the
  /// bodies. The wait is needed because ground that settles bounces before it flows.
  bool has_come_to_rest(const Simulation& simulation) const;
  SnapshotSeries& snapshots() { return snapshots_; }

 private:
  /// Whether an instant of a picture has been reached; removes it from those to come.
  bool picture_is_due(double time);

  const Case& case_;
  const OutlineFinder& outlines_;
  RunSoFar so_far_;
  Checkpoints checkpoints_;
  History history_;
  ProfileTable profiles_;
  std::optional<SurfaceMapTable> surface_map_;  ///< in 3D
  SnapshotSeries snapshots_;
  PictureBook pictures_;
  PressureNoise noise_;
  TerrainMaps maps_;
  SurfaceForces forces_;
  Gauges gauges_;
  double stop_below_;                  ///< share of the largest kinetic energy; 0: never
  double stop_after_;                  ///< [s]
  std::vector<double> picture_times_;  ///< to come, ascending [s]
  Schedule checkpoint_times_;
  double checkpoint_wall_;  ///< interval on the clock [s]
  RunClock clock_;
  double checkpoint_at_;  ///< when the last checkpoint was written, on the clock [s]
};

}  // namespace talus
