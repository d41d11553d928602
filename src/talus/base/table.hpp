#pragma once
/// Tables of numbers with named columns, and formulas of them.

#include <string>
#include <vector>

namespace talus {

struct NumberTable {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;
  std::vector<int> lines{};  ///< line numbers of the rows in the file; empty if the table is not from a file

  int column(const std::string& name) const;  ///< -1 if there is none
};

/// Result of a computation: one row per instant or per run.
struct ResultTable : NumberTable {
  std::vector<std::string> units, meanings;  ///< of the columns
  std::string failure;                       ///< reason for an early end; else empty
};

/// The result as a CSV file, units in the header.
std::string as_csv(const ResultTable& result);

/// Largest size of a CSV file: ten million particles. In memory it is about ten times as large.
inline constexpr double most_csv_bytes = 1e9;

/// Reads a CSV file with a header; lines that begin with # are skipped, and text that is not a number becomes NaN. With
/// `where`, only the rows whose column of that name reads `is`. Throws std::runtime_error.
NumberTable read_csv(const std::string& path, const std::string& where = "", const std::string& is = "");

/// Evaluates a formula of the columns (muParser's syntax) in every row. Throws std::runtime_error if the formula is
/// invalid.
std::vector<double> evaluate(const std::string& formula, const NumberTable& table);

}  // namespace talus
