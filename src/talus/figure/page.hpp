#pragma once
/// Remade figures on paper: panels as SVG and PNG, a page for each figure, and an index of all verdicts.

#include <filesystem>

#include "talus/figure/evaluation.hpp"

namespace talus {

/// A figure that was remade.
struct RemadeFigure {
  FigureSpec spec;
  FigureRuns runs;
  FigureResult result;
};

/// Where the results of a curve's run stand, seen from the figure's folder. Runs of the same case share a folder: that of
/// the first curve.
std::filesystem::path run_folder(const FigureSpec& figure, std::size_t reading, const CurveSpec& curve,
                                 std::size_t run);

/// Writes a figure into a folder: index.html, PANEL.svg and .png with their script and data, and for every curve its
/// test (.toml) and its result (.csv); other readings than the first in folders of their own. False if there is no
/// gnuplot, and so no panels.
bool write_figure(const std::filesystem::path& folder, const RemadeFigure& figure);

/// Writes index.html for figures that stand in folders of their names beside it.
void write_figure_index(const std::filesystem::path& file, const std::vector<RemadeFigure>& figures);

}  // namespace talus
