#pragma once
/// The index of remade figures: how many of their claims hold, and which do not.

#include <filesystem>
#include <vector>

#include "talus/figure/results.hpp"

namespace talus {

/// Writes index.html for figures that stand in folders of their names beside it.
void write_figure_index(const std::filesystem::path& file, const std::vector<RemadeFigure>& figures);

}  // namespace talus
