#pragma once
/// history.csv: what a run does in time, a row an instant.

#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "talus/mpm/simulation.hpp"
#include "talus/output/outline.hpp"
#include "talus/output/plot.hpp"

namespace talus {

class History {
 public:
  /// Creates the file and writes its header, column names with units; or goes on after the first `bytes` of what it
  /// holds. Throws std::runtime_error, as does `add`, if it cannot be written.
  History(const std::filesystem::path& file, int dim, bool axisymmetric, long bytes = 0);
  void add(const Ledger& ledger, const Outline& outline);

  const std::vector<std::string>& columns() const { return columns_; }
  /// Number of a column, by its name with unit.
  int column(const std::string& name) const;
  /// Length of the file.
  long bytes() const { return bytes_; }

 private:
  void write(const std::string& line);

  int dim_;
  bool axisymmetric_;
  std::filesystem::path path_;
  std::vector<std::string> columns_;
  std::ofstream file_;
  long bytes_;
};

/// What of a history is drawn: fronts, height, energies, time step, separated particles.
std::vector<Chart> charts_of(const History& history);

}  // namespace talus
