#pragma once
/// Panels of remade figures, drawn by gnuplot.

#include <filesystem>
#include <vector>

#include "talus/figure/evaluation.hpp"

namespace talus {

/// Draws a panel with its curves: PANEL.svg and PANEL.png in `folder`, with their script (.gp) and points (.dat); nothing if
/// there are no curves. False if there is no gnuplot.
bool draw_panel(const std::filesystem::path& folder, const FigureSpec& figure, const Panel& panel,
                const std::vector<DrawnCurve>& curves);

}  // namespace talus
