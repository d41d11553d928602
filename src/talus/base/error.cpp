#include "talus/base/error.hpp"

#include <algorithm>
#include <tuple>

namespace talus {

std::string Complaint::to_string() const {
  std::string where = file;
  if (line > 0) where += ":" + std::to_string(line) + ":" + std::to_string(column);
  return where.empty() ? text : where + ": " + text;
}

namespace {

std::string all_lines(const std::vector<Complaint>& complaints) {
  std::string lines;
  for (const Complaint& c : complaints) lines += (lines.empty() ? "" : "\n") + c.to_string();
  return lines;
}

std::vector<Complaint> in_file_order(std::vector<Complaint> complaints) {
  std::stable_sort(complaints.begin(), complaints.end(), [](const Complaint& a, const Complaint& b) {
    return std::tie(a.file, a.line, a.column) < std::tie(b.file, b.line, b.column);
  });
  return complaints;
}

}  // namespace

InputError::InputError(std::vector<Complaint> complaints)
    : std::runtime_error(all_lines(in_file_order(complaints))), complaints_(in_file_order(std::move(complaints))) {}

}  // namespace talus
