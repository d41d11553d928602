#include <fmt/format.h>

#include <filesystem>

#include "talus/app/commands.hpp"
#include "talus/base/error.hpp"
#include "talus/base/file.hpp"
#include "talus/figure/comparison.hpp"

namespace talus {

namespace fs = std::filesystem;

int compare_runs(const CompareOptions& options) {
  const auto name_of = [](const std::string& folder) {
    const fs::path path = fs::absolute(folder).lexically_normal();
    return (path.has_filename() ? path.filename() : path.parent_path().filename()).string();
  };
  std::string name_a = name_of(options.folder_a), name_b = name_of(options.folder_b);
  const fs::path file =
      options.out.empty() ? fs::path("out") / fmt::format("compare_{}_{}.html", name_a, name_b) : fs::path(options.out);
  if (name_a == name_b) {
    name_a = fs::path(options.folder_a).lexically_normal().string();
    name_b = fs::path(options.folder_b).lexically_normal().string();
  }
  const ComparedRun a = read_run(options.folder_a, name_a), b = read_run(options.folder_b, name_b);
  if (file.has_parent_path()) fs::create_directories(file.parent_path());
  write_whole(file, comparison_page(a, b));
  double largest = 0;
  for (const ColumnDifference& d : differences(a.history, b.history)) largest = std::max(largest, d.relative);
  if (largest == 0)
    fmt::print("no difference in history.csv\n");
  else
    for (const ColumnDifference& d : differences(a.history, b.history))
      if (d.largest > 0)
        fmt::print("{:<32} {:>12.6g} {:>12.6g}   largest difference {:.3g} ({:.3g} %)\n",
                   d.name + (d.unit == "1" ? "" : " [" + d.unit + "]"), d.end_a, d.end_b, d.largest, 100 * d.relative);
  fmt::print("page: {}\n", fs::absolute(file).string());
  return 0;
}

}  // namespace talus
