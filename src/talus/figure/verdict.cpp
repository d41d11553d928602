#include "talus/figure/verdict.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cmath>

#include "talus/output/page.hpp"

namespace talus {

Finding finding_of(const Statement& s, const Verdict& v) {
  if (s.number.empty()) return Finding::unchecked;
  return v.in_first() ? Finding::holds : v.in_another() ? Finding::in_another : Finding::fails;
}

std::string badge(const FigureSpec& figure, const Statement& s, const Verdict& v) {
  switch (finding_of(s, v)) {
    case Finding::unchecked: return "<span class=\"badge open\">cannot be checked</span>";
    case Finding::holds: return "<span class=\"badge yes\">holds</span>";
    case Finding::in_another: {
      std::vector<std::string> where;
      for (std::size_t r = 1; r < v.holds.size(); ++r)
        if (v.holds[r]) where.push_back(figure.readings[r].name);
      return fmt::format("<span class=\"badge part\">holds only in {}</span>",
                         escaped(fmt::format("{}", fmt::join(where, ", "))));
    }
    case Finding::fails: break;
  }
  return "<span class=\"badge no\">does not hold</span>";
}

std::string range_in_words(const Statement& s) {
  if (s.number.empty()) return "";
  if (s.at_least && s.at_most) return fmt::format("{:.4g} to {:.4g}", *s.at_least, *s.at_most);
  return s.at_least ? fmt::format("at least {:.4g}", *s.at_least) : fmt::format("at most {:.4g}", *s.at_most);
}

std::string number_in_words(double x) { return std::isfinite(x) ? fmt::format("{:.4g}", x) : "&ndash;"; }

FindingCounts count_findings(const RemadeFigure& figure) {
  FindingCounts n{};
  for (std::size_t s = 0; s < figure.spec.statements.size(); ++s)
    ++n[int(finding_of(figure.spec.statements[s], figure.result.verdicts[s]))];
  return n;
}

}  // namespace talus
