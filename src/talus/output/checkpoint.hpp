#pragma once
/// Checkpoints: the state of a run, so that it can be stopped and resumed as if it had not stopped.
///
/// A run keeps its last two in its folder, checkpoint_0.h5 and checkpoint_1.h5, and always replaces the older.
/// Each is an HDF5 file: `case` is the text of the case; `run` (JSON) has version and build of talus and what the run has
/// written so far; the group `state` holds the arrays of Simulation::save. 512 bytes before it, its user block, say what
/// it is and have the CRC-32 of the rest.

#include <cmath>
#include <filesystem>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "talus/input/read.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus {

/// Regular instants: something happens at the first step at or after each.
struct Schedule {
  double interval = 0;  ///< [s]
  double next = 0;      ///< number of the instant to come
  double last = -1;     ///< time at which something happened [s]

  bool due(double time) {
    if (time < next * interval * (1 - 1e-12)) return false;
    next = std::floor(time / interval * (1 + 1e-12)) + 1;
    last = time;
    return true;
  }
};

/// The case of a run, and what the run has written up to a checkpoint.
struct RunSoFar {
  std::string case_file;
  std::string case_text;
  double end = 0;   ///< [s]
  double time = 0;  ///< [s]
  long step = 0;
  long history_bytes = 0;                   ///< length of history.csv
  long profile_bytes = 0;                   ///< length of surface.csv, in 3D of rings.csv
  long surface_map_bytes = 0;               ///< length of surface.csv in 3D
  long gauge_bytes = 0;                     ///< length of gauges.csv
  std::vector<double> snapshots, instants;  ///< times of the snapshots, and of the instants in pictures [s]
  Schedule next_snapshot{}, next_row{};
  std::vector<double> pressure_noise;  ///< state of PressureNoise
  std::vector<double> maps;            ///< state of TerrainMaps
  std::vector<double> forces;          ///< state of SurfaceForces
  std::vector<double> profile;         ///< state of the profile along the thalweg
  std::vector<double> gauges;          ///< state of Gauges
  double map_checksum = 0;             ///< of the maps that the case has read
  double peak_kinetic = 0;             ///< largest kinetic energy so far [J]
  double last_flow = 0;                ///< when kinetic energy last was above the share of it that ends a run [s]
  double wall_seconds = 0, cpu_seconds = 0;
  std::vector<double> resumed_at;  ///< times from which the run was resumed [s]
};

/// A checkpoint as it was read.
struct SavedRun {
  std::filesystem::path file;
  long number = 0;  ///< of the checkpoints that the run has made
  RunSoFar so_far;

  /// Reads the arrays of Simulation::save, a piece at a time. The file stays open as long as the function is there.
  ReadArray arrays() const;
  /// All of these arrays.
  std::map<std::string, std::vector<double>> state() const;
};

/// Writes the parts of all processes into the arrays of a checkpoint.
using FillArrays = std::function<void(const std::filesystem::path& file)>;

/// Reads a checkpoint. Throws std::runtime_error with the reason if it cannot be used.
SavedRun read_checkpoint(const std::filesystem::path& file);

/// The checkpoints of a run.
class Checkpoints {
 public:
  /// For a run in a folder; `saved` is the checkpoint it resumes from, null for a new run.
  Checkpoints(std::filesystem::path folder, const SavedRun* saved);

  /// Writes one, with the arrays of Simulation::save, in place of the older of the last two; it is on the disk when this
  /// returns. `fill`: of several processes. Throws std::runtime_error if it cannot be written; the last two then stay as they
  /// are.
  void write(const RunSoFar& so_far, const std::vector<StateArray>& arrays, const FillArrays& fill = {});
  /// The last one.
  std::string last() const;

  static std::filesystem::path file(const std::filesystem::path& folder, int place);
  static bool any_in(const std::filesystem::path& folder);

 private:
  std::filesystem::path folder_;
  int place_;  ///< of the last one
  long number_;
  double time_ = 0;
  long step_ = 0;
};

/// The newest usable checkpoint in a folder, of a run of the case with these settings; none if the folder has none. Calls
/// `refused` with the reason another one is not used. Throws InputError, with all reasons, if none of them is usable.
std::optional<SavedRun> newest_checkpoint(const std::filesystem::path& folder,
                                          const std::vector<Understood>& understood,
                                          const std::function<void(const std::string&)>& refused);

}  // namespace talus
