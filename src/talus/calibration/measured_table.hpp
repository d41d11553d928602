#pragma once
/// Tables of measurements as laboratories and simulations leave them: CSV with text in some columns.

#include <string>
#include <string_view>
#include <vector>

namespace talus {

/// A CSV file cell by cell. The header is the first line that is no comment (#); if that line holds numbers, it is the last
/// comment before it with as many cells.
struct MeasuredTable {
  std::string path;
  std::vector<std::string> names;
  std::vector<std::vector<std::string>> cells;
  std::vector<int> lines;  ///< of the file, for each row

  int column(std::string_view name) const;  ///< -1 if there is none
  /// The texts of a column, each once, in the order of the file.
  std::vector<std::string> values_of(int column) const;
  /// Rows whose cell in a column is a text, or the same number written otherwise.
  MeasuredTable where(int column, std::string_view is) const;
  /// Rows in which a formula of the columns holds, `rate <= 0.01`. Throws std::runtime_error where it is wrong.
  MeasuredTable only(const std::string& formula) const;
  /// The value of a formula in every row. It can name columns whose names are identifiers: `q_kPa`, but not `q [kPa]`.
  /// Throws std::runtime_error where it is wrong.
  std::vector<double> compute(const std::string& formula) const;
  /// The cells of a column as numbers, NaN where there is none.
  std::vector<double> numbers_of(int column) const;
};

/// Reads a file. Throws std::runtime_error with the line where it is wrong.
MeasuredTable read_measured_table(const std::string& path);

}  // namespace talus
