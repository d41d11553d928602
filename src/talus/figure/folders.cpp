#include "talus/figure/folders.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <fstream>
#include <stdexcept>

#include "talus/base/error.hpp"
#include "talus/base/text.hpp"

namespace talus {

namespace fs = std::filesystem;

std::vector<fs::path> figure_folders(const fs::path& from, const std::string& figure) {
  std::vector<fs::path> folders;
  std::error_code failure;
  for (const auto& entry : fs::directory_iterator(from, failure))
    if (fs::exists(entry.path() / "figure.toml")) folders.push_back(entry.path());
  std::sort(folders.begin(), folders.end());
  if (folders.empty())
    throw InputError(fmt::format("{} holds no folders with a figure.toml; name the folder with --from", from.string()));
  if (figure == "all") return folders;
  std::vector<std::string> names;
  for (const fs::path& f : folders) {
    names.push_back(f.filename().string());
    if (names.back() == figure || names.back() == fmt::format("figure_{:0>2}", figure)) return {f};
  }
  const std::vector<std::string_view> words(names.begin(), names.end());
  const std::string_view alike = most_alike(figure, words);
  throw InputError(
      fmt::format("`{}` is no figure; {}", figure,
                  alike.empty() ? "there is all, " + any_of(words) : fmt::format("did you mean `{}`?", alike)));
}

fs::path reading_folder(const fs::path& figure_folder, const FigureSpec& figure, std::size_t reading) {
  return reading == 0 ? figure_folder : figure_folder / figure.readings[reading].name;
}

fs::path run_folder(const FigureSpec& figure, std::size_t reading, const CurveSpec& curve, std::size_t run) {
  const std::string& text = curve.runs[reading]->runs[run].text;
  for (std::size_t r = 0; r < figure.readings.size(); ++r)
    for (const CurveSpec& c : figure.curves)
      if (!c.runs.empty() && c.runs[r])
        for (std::size_t k = 0; k < c.runs[r]->runs.size(); ++k)
          if (c.runs[r]->runs[k].text == text)
            return reading_folder("", figure, r) / (c.name + (c.is_sweep() ? fmt::format("_{}", k + 1) : ""));
  throw std::logic_error("a run that is not of this figure");
}

void write_text(const fs::path& file, const std::string& text) {
  std::ofstream out(file);
  out << text;
  if (!out.flush()) throw std::runtime_error("cannot write " + file.string());
}

}  // namespace talus
