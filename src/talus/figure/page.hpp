#pragma once
/// The page of a remade figure.

#include <filesystem>

#include "talus/figure/results.hpp"

namespace talus {

/// Writes a figure into a folder: index.html, PANEL.svg and .png with their script and data, and for every curve its
/// test (.toml) and its result (.csv); other readings than the first in folders of their own. False if there is no
/// gnuplot, and so no panels.
bool write_figure(const std::filesystem::path& folder, const RemadeFigure& figure);

}  // namespace talus
