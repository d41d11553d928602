#pragma once
/// Folders and files of figures: where they are specified, and where their results stand.

#include <filesystem>
#include <string>
#include <vector>

#include "talus/figure/specification.hpp"

namespace talus {

/// Folders in `from` that hold a figure.toml, in the order of their names: all of them if `figure` is "all", else the one
/// with this name or number. Throws InputError if there is none.
std::vector<std::filesystem::path> figure_folders(const std::filesystem::path& from, const std::string& figure);

/// Folder of the results of a reading: that of the figure itself for the first, one inside it for each other.
std::filesystem::path reading_folder(const std::filesystem::path& figure_folder, const FigureSpec& figure,
                                     std::size_t reading);

/// Folder of the results of a curve's run, relative to the figure's folder. Runs of the same case share a folder: that of
/// the first curve.
std::filesystem::path run_folder(const FigureSpec& figure, std::size_t reading, const CurveSpec& curve,
                                 std::size_t run);

/// Writes a file of a figure. Throws std::runtime_error if it cannot be written.
void write_text(const std::filesystem::path& file, const std::string& text);

}  // namespace talus
