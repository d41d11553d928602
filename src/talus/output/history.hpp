#pragma once
/// history.csv and surface.csv: time histories of a run.

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "talus/base/units.hpp"
#include "talus/mpm/simulation.hpp"
#include "talus/output/outline.hpp"
#include "talus/output/plot.hpp"

namespace talus {

/// A CSV file that grows while a run goes on.
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

/// history.csv: a row an instant.
class History : public GrowingTable {
 public:
  History(const std::filesystem::path& file, const Case& case_, long bytes = 0);
  /// `of_surfaces`: what SurfaceForces::row returned.
  void add(const Ledger& ledger, const Outline& outline, const std::vector<double>& of_surfaces);

 private:
  std::vector<double (*)(const Ledger&, const Outline&)> values_;  ///< of the columns
};

/// surface.csv: thickness of the material at the instants of snapshots; a row for each strip of ground, or ring.
class SurfaceTable : public GrowingTable {
 public:
  SurfaceTable(const std::filesystem::path& file, int dim, bool axisymmetric, long bytes = 0);
  void add(double time, const Surface& surface);
};

/// Charts of a history: fronts, height, forces, mass that has flowed out, energies, time step, separated particles.
std::vector<Chart> charts_of(const History& history, const LengthUnit& unit);

}  // namespace talus
