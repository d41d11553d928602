#pragma once
/// Tables of numbers with named columns, and formulas of them.

#include <string>
#include <vector>

namespace talus {

struct NumberTable {
  std::vector<std::string> names;
  std::vector<std::vector<double>> rows;
  std::vector<int> lines{};  ///< of the file, where the rows stand; empty if they come from elsewhere

  int column(const std::string& name) const;  ///< -1 if there is none
};

/// What a computation reports: a row an instant, or a row a run.
struct ResultTable : NumberTable {
  std::vector<std::string> units, meanings;  ///< of the columns
  std::string failure;                       ///< empty, or why it ended before its end
};

/// The result as a CSV file, units in the header.
std::string as_csv(const ResultTable& result);

/// Bytes that a CSV file may have: ten million particles; in memory it is some ten times as large.
inline constexpr double most_csv_bytes = 1e9;

/// Reads a CSV file with a header; lines that begin with # are skipped, and what is no number becomes NaN. With
/// `where`, only the rows whose column of that name reads `is`. Throws std::runtime_error.
NumberTable read_csv(const std::string& path, const std::string& where = "", const std::string& is = "");

/// The value of a formula of the columns (muParser's syntax) in every row. Throws std::runtime_error where the formula
/// is wrong.
std::vector<double> evaluate(const std::string& formula, const NumberTable& table);

}  // namespace talus
