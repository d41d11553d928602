#pragma once
/// Verdicts on the claims about a figure, as pages show them.

#include <array>
#include <string>

#include "talus/figure/results.hpp"

namespace talus {

enum class Finding { holds, in_another, fails, unchecked };
/// How many statements have each finding.
using FindingCounts = std::array<int, 4>;

Finding finding_of(const Statement& s, const Verdict& v);
FindingCounts count_findings(const RemadeFigure& figure);

/// A finding as a coloured word in HTML.
std::string badge(const FigureSpec& figure, const Statement& s, const Verdict& v);

/// The range in which a statement holds; empty if no number decides.
std::string range_in_words(const Statement& s);

/// A number in HTML; a dash for NaN.
std::string number_in_words(double x);

}  // namespace talus
