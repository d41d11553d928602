#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "talus/base/table.hpp"
#include "talus/base/text.hpp"
#include "talus/case/check.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr Text file_of_points{"file", "CSV file with columns x, y, in 3D z [m], and optionally volume [m3]"};

/// The columns of coordinates and, last, of the volume; -1 where there is none. Throws if there are other columns.
std::vector<int> columns_of(const NumberTable& table, const std::string& path, int dim) {
  std::vector<std::string_view> known(axis_names, axis_names + dim);
  known.push_back("volume");
  std::vector<int> columns;
  for (std::string_view name : known) columns.push_back(table.column(std::string(name)));
  for (int a = 0; a < dim; ++a)
    if (columns[std::size_t(a)] < 0)
      throw std::runtime_error(
          fmt::format("{} has no column `{}`; its first line must name the columns {}, and names {}", path,
                      axis_names[a], fmt::join(known.begin(), known.begin() + dim, ","), fmt::join(table.names, ",")));
  for (const std::string& name : table.names)
    if (std::find(known.begin(), known.end(), name) == known.end())
      throw std::runtime_error(fmt::format("{} has a column `{}`, which is none of {}", path, name, any_of(known)));
  return columns;
}

/// The points of a file. Throws std::runtime_error with what is wrong with it.
PointList points_of(const std::string& path, int dim, std::optional<double> spacing) {
  const NumberTable table = read_csv(path);
  if (table.rows.empty()) throw std::runtime_error(fmt::format("{} holds no rows", path));
  const std::vector<int> columns = columns_of(table, path, dim);
  const int of_volume = columns.back();
  if (of_volume >= 0 && spacing) throw std::runtime_error(fmt::format("{} has volumes: remove `spacing`", path));
  if (of_volume < 0 && !spacing)
    throw std::runtime_error(fmt::format("{} has no volumes: add `spacing`; each particle has its {} as volume", path,
                                         dim == 2 ? "square" : "cube"));
  PointList list;
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    const std::vector<double>& row = table.rows[i];
    Vec<3> x{};
    const double v = of_volume >= 0 ? row[std::size_t(of_volume)] : std::pow(*spacing, dim);
    bool finite = std::isfinite(v);
    for (int a = 0; a < dim; ++a) {
      x[a] = row[std::size_t(columns[std::size_t(a)])];
      finite &= std::isfinite(x[a]);
    }
    if (!finite) throw std::runtime_error(fmt::format("{}:{}: a value is missing or not finite", path, table.lines[i]));
    if (!(v > 0))
      throw std::runtime_error(fmt::format("{}:{}: the volume must be greater than 0", path, table.lines[i]));
    list.places.push_back(x);
    list.volumes.push_back(v);
  }
  if (const auto two = coincident_points(list, dim))
    throw std::runtime_error(fmt::format("{}:{}: the point is at the same place as that of line {}; delete one of them",
                                         path, table.lines[two->second], table.lines[two->first]));
  return list;
}

}  // namespace

const Declaration& points_declaration() {
  static const Declaration d("a list of points", {required(file_of_points)});
  return d;
}

Region read_points(Section& s, int dim, const std::string& folder, std::optional<double> spacing) {
  const std::string file = s.text(file_of_points);
  s.close();
  if (file.empty()) return Box{};
  try {
    return points_of((std::filesystem::path(folder) / file).string(), dim, spacing);
  } catch (const std::runtime_error& e) {
    s.complain("file", e.what());
    return Box{};
  }
}

}  // namespace talus
