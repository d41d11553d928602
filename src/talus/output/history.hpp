#pragma once
/// history.csv, surface.csv and rings.csv: tables that grow during a run.

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "talus/base/units.hpp"
#include "talus/mpm/simulation.hpp"
#include "talus/output/outline.hpp"
#include "talus/output/plot.hpp"
#include "talus/output/surface_map.hpp"

namespace talus {

/// A CSV file that grows during a run.
class GrowingTable {
 public:
  /// Creates the file and writes its header, column names with units; or continues an existing one after its first
  /// `bytes`. Throws std::runtime_error, as does `add`, if it cannot be written.
  GrowingTable(const std::filesystem::path& file, std::vector<std::string> columns, long bytes = 0);
  void add(const std::vector<std::vector<double>>& rows);

  const std::filesystem::path& file() const { return path_; }
  const std::vector<std::string>& columns() const { return columns_; }
  /// Number of a column, by its name with unit; -1 if there is none.
  int column(const std::string& name) const;
  /// Length of the file.
  long bytes() const { return bytes_; }

 private:
  void write(const std::string& text);

  std::filesystem::path path_;
  std::vector<std::string> columns_;
  std::ofstream file_;
  long bytes_;
};

/// history.csv: one row per instant.
class History : public GrowingTable {
 public:
  History(const std::filesystem::path& file, const Case& case_, long bytes = 0);
  /// `of_surfaces`: what SurfaceForces::row returned.
  void add(const Ledger& ledger, const Outline& outline, const std::vector<double>& of_surfaces);

 private:
  std::vector<double (*)(const Ledger&, const Outline&)> values_;  ///< of the columns
};

/// Thickness of the material at the instants of snapshots; a row for each strip of ground, or ring: surface.csv, in 3D
/// rings.csv.
class ProfileTable : public GrowingTable {
 public:
  ProfileTable(const std::filesystem::path& folder, const Case& case_, long bytes = 0);
  void add(double time, const Surface& surface);
};

/// surface.csv of a run in 3D: thickness and speed of the material on each patch of ground, at the instants of snapshots.
class SurfaceMapTable : public GrowingTable {
 public:
  SurfaceMapTable(const std::filesystem::path& folder, long bytes = 0);
  void add(double time, const std::vector<SurfacePatch>& patches);
};

/// The file of a run that ProfileTable wrote: rings.csv if the folder has one, otherwise surface.csv.
std::filesystem::path profile_file(const std::filesystem::path& folder);

/// Charts of a history: fronts, height, forces, mass that has flowed out, energies, time step, separated particles.
std::vector<Chart> charts_of(const History& history, const LengthUnit& unit);

}  // namespace talus
