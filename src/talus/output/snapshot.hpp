#pragma once
/// Snapshots of all particles, for ParaView and for scripts.
///
/// Each is an HDF5 file in VTK's layout (VTKHDF 1.0, UnstructuredGrid of vertices), each field is a dataset
/// under VTKHDF/PointData with the attributes `units` and `meaning`. ParaView opens the time series with the file
/// NAME.hdf.series beside them.

#include <filesystem>
#include <functional>
#include <future>
#include <string>
#include <vector>

#include "talus/base/file.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus {

/// Writes the fields with the given names (those that exist) and the positions. The file appears whole or not at all.
/// Throws std::runtime_error if it cannot be written.
void write_snapshot(const std::filesystem::path& file, const Observation& seen, const std::vector<std::string>& fields);

/// A snapshot of which several processes write the fields: the first one makes the file, all fill it, then the first one
/// finishes it.
class UnfilledSnapshot {
 public:
  /// Makes the file; `part`: of any process. Throws std::runtime_error if it cannot be written.
  UnfilledSnapshot(const std::filesystem::path& file, const ObservedPart& part, const std::vector<std::string>& fields);
  const std::filesystem::path& file() const { return whole_.unfinished(); }
  void finish() { whole_.finish(); }

 private:
  WholeFile whole_;
};

/// Writes rows of a dataset, which has `components` numbers in each, from row `first` on.
using WriteRows = std::function<void(const std::string& dataset, std::size_t first, int components,
                                     const std::vector<double>& values)>;

/// Writes the fields of a part of the particles.
void fill_snapshot(const ObservedPart& part, const std::vector<std::string>& fields, const WriteRows& write);

/// Reads a snapshot of write_snapshot: the positions, then the fields by name. Throws std::runtime_error if the file is not
/// one. `every`: the first of so many particles only.
Observation read_snapshot(const std::filesystem::path& file, std::size_t every = 1);

/// Particles in a snapshot. Throws as read_snapshot.
std::size_t particles_in(const std::filesystem::path& snapshot);

/// The files that a series file lists, in its order. Throws std::runtime_error if it cannot be read.
std::vector<std::filesystem::path> read_series(const std::filesystem::path& series_file);

/// The snapshots of a run: numbered files and the series file that lists them with their times. A snapshot is written
/// in a thread of its own; the next one waits for it, and throws its errors.
class SnapshotSeries {
 public:
  /// Files FOLDER/particles_0000.hdf ... and FOLDER/particles.hdf.series. `times` are those of the snapshots that are
  /// there already [s]; others, from another run or one that has gone further, are removed.
  SnapshotSeries(std::filesystem::path folder, std::vector<std::string> fields, std::vector<double> times = {});
  void add(Observation seen);
  /// The same for a snapshot that `write` writes into a file before it returns.
  void add(double time, const std::function<void(const std::filesystem::path& file)>& write);
  /// Waits until the last one is written. HDF5 must not be used elsewhere before.
  void finish() {
    if (writing_.valid()) writing_.get();
  }
  /// The last file, once it is finished; empty if there is none.
  std::filesystem::path last() const { return times_.empty() ? std::filesystem::path() : file(size() - 1); }
  std::filesystem::path file(int number) const;
  std::filesystem::path series_file() const { return folder_ / "particles.hdf.series"; }
  int size() const { return int(times_.size()); }
  const std::vector<double>& times() const { return times_; }

 private:
  /// Text of the series file.
  std::string list() const;

  std::filesystem::path folder_;
  std::vector<std::string> fields_;
  std::vector<double> times_;
  std::future<void> writing_;  ///< last member: its destructor waits
};

}  // namespace talus
