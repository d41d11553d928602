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
  /// Creates the file and writes its header: column names with units.
  History(const std::filesystem::path& file, int dim);
  void add(const Ledger& ledger, const Outline& outline);

  const std::vector<std::string>& columns() const { return columns_; }
  /// Number of a column, by its name with unit.
  int column(const std::string& name) const;
  const std::vector<std::vector<double>>& rows() const { return rows_; }

 private:
  int dim_;
  std::vector<std::string> columns_;
  std::vector<std::vector<double>> rows_;
  std::ofstream file_;
};

/// What of a history is drawn: fronts, height, energies, time step, separated particles.
std::vector<Chart> charts_of(const History& history);

}  // namespace talus
