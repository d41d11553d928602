#include "talus/calibration/measured_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fstream>
#include <limits>
#include <stdexcept>

#include "talus/base/file.hpp"
#include "talus/base/table.hpp"

namespace talus {

namespace {

constexpr double no_number = std::numeric_limits<double>::quiet_NaN();

std::string_view trimmed_cell(std::string_view s) {
  s.remove_prefix(std::min(s.find_first_not_of(" \t\""), s.size()));
  s.remove_suffix(s.size() - std::min(s.find_last_not_of(" \t\"") + 1, s.size()));
  return s;
}

double number_in(std::string_view cell) {
  if (!cell.empty() && cell[0] == '+') cell.remove_prefix(1);
  double value = no_number;
  const auto [end, failure] = std::from_chars(cell.data(), cell.data() + cell.size(), value);
  return failure == std::errc() && end == cell.data() + cell.size() ? value : no_number;
}

std::vector<std::string> split_cells(std::string_view line) {
  std::vector<std::string> cells;
  for (;;) {
    const std::size_t comma = std::min(line.find(','), line.size());
    cells.emplace_back(trimmed_cell(line.substr(0, comma)));
    if (comma == line.size()) return cells;
    line.remove_prefix(comma + 1);
  }
}

bool is_identifier(const std::string& name) {
  return !name.empty() && !std::isdigit(static_cast<unsigned char>(name[0])) &&
         std::all_of(name.begin(), name.end(), [](unsigned char c) { return std::isalnum(c) || c == '_'; });
}

/// The rows of a table, by number, that fulfil a condition.
template <class Condition>
MeasuredTable rows_of(const MeasuredTable& table, Condition holds) {
  MeasuredTable chosen{table.path, table.names, {}, {}};
  for (std::size_t i = 0; i < table.cells.size(); ++i) {
    if (!holds(i)) continue;
    chosen.cells.push_back(table.cells[i]);
    chosen.lines.push_back(table.lines[i]);
  }
  return chosen;
}

}  // namespace

int MeasuredTable::column(std::string_view name) const {
  const auto found = std::find(names.begin(), names.end(), name);
  return found == names.end() ? -1 : int(found - names.begin());
}

std::vector<std::string> MeasuredTable::values_of(int column) const {
  std::vector<std::string> values;
  for (const auto& row : cells)
    if (std::find(values.begin(), values.end(), row[std::size_t(column)]) == values.end())
      values.push_back(row[std::size_t(column)]);
  return values;
}

MeasuredTable MeasuredTable::where(int column, std::string_view is) const {
  const double as_number = number_in(is);
  return rows_of(*this, [&](std::size_t i) {
    const std::string& cell = cells[i][std::size_t(column)];
    return cell == is || number_in(cell) == as_number;
  });
}

MeasuredTable MeasuredTable::only(const std::string& formula) const {
  const std::vector<double> values = compute(formula);
  return rows_of(*this, [&](std::size_t i) { return values[i] != 0 && !std::isnan(values[i]); });
}

std::vector<double> MeasuredTable::compute(const std::string& formula) const {
  NumberTable nameable;
  nameable.rows.resize(cells.size());
  for (std::size_t c = 0; c < names.size(); ++c) {
    if (!is_identifier(names[c])) continue;
    nameable.names.push_back(names[c]);
    for (std::size_t i = 0; i < cells.size(); ++i) nameable.rows[i].push_back(number_in(cells[i][c]));
  }
  return evaluate(formula, nameable);
}

std::vector<double> MeasuredTable::numbers_of(int column) const {
  std::vector<double> numbers;
  for (const auto& row : cells) numbers.push_back(number_in(row[std::size_t(column)]));
  return numbers;
}

MeasuredTable read_measured_table(const std::string& path) {
  expect_file(path, std::uintmax_t(1e8));
  std::ifstream file(path);
  if (!file) throw std::runtime_error(fmt::format("{} cannot be read", path));
  MeasuredTable table{path, {}, {}, {}};
  std::vector<std::vector<std::string>> comments;
  std::string line;
  for (int at = 1; std::getline(file, line); ++at) {
    if (at == 1 && line.starts_with("\xef\xbb\xbf")) line.erase(0, 3);
    if (!line.empty() && line.back() == '\r') line.pop_back();
    if (trimmed_cell(line).empty()) continue;
    if (line[0] == '#') {
      comments.push_back(split_cells(std::string_view(line).substr(1)));
      continue;
    }
    std::vector<std::string> cells = split_cells(line);
    if (table.names.empty()) {
      if (cells.size() == 1 && cells[0].find(';') != std::string::npos)
        throw std::runtime_error(fmt::format("{}:{}: columns are separated by `;`; write commas", path, at));
      const bool is_header =
          std::none_of(cells.begin(), cells.end(), [](const auto& c) { return number_in(c) == number_in(c); });
      if (is_header) {
        table.names = cells;
      } else {
        const auto header = std::find_if(comments.rbegin(), comments.rend(),
                                         [&](const auto& c) { return c.size() == cells.size() && c.size() > 1; });
        if (header == comments.rend())
          throw std::runtime_error(
              fmt::format("{}:{}: numbers without a header; write the names of the {} columns in a line before", path,
                          at, cells.size()));
        table.names = *header;
      }
      for (auto name = table.names.begin(); name != table.names.end(); ++name)
        if (std::find(table.names.begin(), name, *name) != name)
          throw std::runtime_error(fmt::format("{}:{}: two columns are called `{}`", path, at, *name));
      if (is_header) continue;
    }
    if (cells.size() != table.names.size())
      throw std::runtime_error(
          fmt::format("{}:{}: {} cells, but {} columns", path, at, cells.size(), table.names.size()));
    table.cells.push_back(std::move(cells));
    table.lines.push_back(at);
  }
  if (table.cells.empty()) throw std::runtime_error(fmt::format("{} holds no rows of numbers", path));
  return table;
}

}  // namespace talus
