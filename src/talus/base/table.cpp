#include "talus/base/table.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <muParser.h>

#include <algorithm>
#include <charconv>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "talus/base/file.hpp"
#include "talus/base/text.hpp"

namespace talus {

int NumberTable::column(const std::string& name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : int(found - names.begin());
}

std::string as_csv(const ResultTable& result) {
  std::vector<std::string> header;
  for (std::size_t c = 0; c < result.names.size(); ++c)
    header.push_back(result.units[c] == "1" ? result.names[c]
                                            : fmt::format("{} [{}]", result.names[c], result.units[c]));
  std::string csv = fmt::format("{}\n", fmt::join(header, ","));
  for (const auto& row : result.rows) csv += fmt::format("{:.10g}\n", fmt::join(row, ","));
  return csv;
}

namespace {

/// The character between the columns of a table, by its first line: spreadsheets also write semicolons, where the comma
/// is the decimal sign, and tabs.
char separator_in(std::string_view header) {
  if (header.find(',') != header.npos) return ',';
  if (header.find(';') != header.npos) return ';';
  return header.find('\t') != header.npos ? '\t' : ',';
}

/// NaN if the text is not a number, such as "12 mm". With semicolons between columns a comma is a decimal sign.
double number_in_cell(std::string_view cell, char separator) {
  cell.remove_prefix(std::min(cell.find_first_not_of(" +"), cell.size()));
  cell.remove_suffix(cell.size() - std::min(cell.find_last_not_of(' ') + 1, cell.size()));
  std::string text(cell);
  if (separator != ',') std::replace(text.begin(), text.end(), ',', '.');
  double value;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), value);
  const bool is_number = failure == std::errc() && end == text.data() + text.size();
  return is_number ? value : std::numeric_limits<double>::quiet_NaN();
}

}  // namespace

NumberTable read_csv(const std::string& path, const std::string& where, const std::string& is) {
  expect_file(path, std::uintmax_t(most_csv_bytes));
  std::ifstream file(path);
  NumberTable table;
  std::string line;
  int chosen = -1, number = 0;
  char separator = ',';
  while (std::getline(file, line)) {
    ++number;
    if (number == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);  // byte-order mark of a spreadsheet
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (line.empty() || line[0] == '#') continue;
    if (table.names.empty()) separator = separator_in(line);
    std::vector<std::string_view> cells;
    for (std::string_view rest = line; !rest.empty();) {
      const std::size_t comma = std::min(rest.find(separator), rest.size());
      cells.push_back(rest.substr(0, comma));
      rest.remove_prefix(std::min(comma + 1, rest.size()));
    }
    if (table.names.empty()) {
      table.names.assign(cells.begin(), cells.end());
      for (auto name = table.names.begin(); name != table.names.end(); ++name)
        if (std::find(table.names.begin(), name, *name) != name)
          throw std::runtime_error(fmt::format("{}:{}: two columns are called `{}`", path, number, *name));
      if (!where.empty()) {
        chosen = table.column(where);
        if (chosen < 0) throw std::runtime_error(fmt::format("{} has no column `{}`", path, where));
      }
      continue;
    }
    if (cells.size() != table.names.size())
      throw std::runtime_error(
          fmt::format("{}:{}: {} cells, but {} columns", path, number, cells.size(), table.names.size()));
    if (chosen >= 0 && cells[chosen] != is) continue;
    std::vector<double> row;
    for (std::string_view c : cells) row.push_back(number_in_cell(c, separator));
    table.rows.push_back(std::move(row));
    table.lines.push_back(number);
  }
  if (table.rows.empty() && !where.empty())
    throw std::runtime_error(fmt::format("{} holds no rows with {} = {}", path, where, is));
  if (file.bad()) throw std::runtime_error(fmt::format("{} cannot be read", path));
  return table;
}

std::vector<double> evaluate(const std::string& formula, const NumberTable& table) {
  std::vector<double> values(table.names.size());
  mu::Parser parser;
  std::vector<double> result;
  try {
    for (std::size_t c = 0; c < table.names.size(); ++c) parser.DefineVar(table.names[c], &values[c]);
    parser.SetExpr(formula);
    for (const auto& row : table.rows) {
      std::copy(row.begin(), row.end(), values.begin());
      result.push_back(parser.Eval());
    }
  } catch (const mu::ParserError& e) {
    const std::vector<std::string_view> names(table.names.begin(), table.names.end());
    const std::string_view alike = most_alike(e.GetToken(), names);
    throw std::runtime_error(fmt::format("{} in `{}`{}", e.GetMsg(), formula,
                                         alike.empty() ? "" : fmt::format("; did you mean `{}`?", alike)));
  }
  return result;
}

}  // namespace talus
