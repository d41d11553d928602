#include "talus/figure/index.hpp"

#include <fmt/format.h>

#include <sstream>

#include "talus/base/machine.hpp"
#include "talus/figure/folders.hpp"
#include "talus/figure/verdict.hpp"
#include "talus/output/page.hpp"

namespace talus {

namespace {

/// The statements with one finding, of all figures.
std::string list_of(const std::vector<RemadeFigure>& figures, Finding which, const char* title) {
  std::string items;
  for (const RemadeFigure& f : figures)
    for (std::size_t i = 0; i < f.spec.statements.size(); ++i) {
      const Statement& s = f.spec.statements[i];
      const Verdict& v = f.result.verdicts[i];
      if (finding_of(s, v) != which) continue;
      const std::string found =
          which == Finding::unchecked
              ? ""
              : fmt::format("{}: {}, not {}. ", escaped(s.meaning), number_in_words(v.numbers[0]), range_in_words(s));
      items += fmt::format("<tr><td><a href=\"{0}/index.html\">{0}</a></td><td>{1}</td><td>{2}{3}{4}</td></tr>\n",
                           escaped(f.spec.name), escaped(s.text), found,
                           which == Finding::in_another ? badge(f.spec, s, v) + " " : "", escaped(s.why));
    }
  return items.empty() ? "" : fmt::format("<h2>{}</h2>\n<table>{}</table>\n", title, items);
}

}  // namespace

void write_figure_index(const std::filesystem::path& file, const std::vector<RemadeFigure>& figures) {
  FindingCounts all{};
  for (const RemadeFigure& f : figures)
    for (int k = 0; k < 4; ++k) all[k] += count_findings(f)[k];
  std::ostringstream page;
  page << page_head("What reproduces") << "<h1>Reproduced figures</h1>\n"
       << fmt::format(
              "<p>Of {} claims in {} figures <b>{} hold</b>, {} hold only in another reading of the source, "
              "<b>{} do not hold</b> and {} cannot be checked. No parameter was tuned. Computed with talus {}.</p>\n",
              all[0] + all[1] + all[2] + all[3], figures.size(), all[0], all[1], all[2], all[3], escaped(version()));
  page << "<table><tr><th>figure</th><th></th><th>holds</th><th>only in another reading</th><th>does not "
          "hold</th><th>cannot be checked</th></tr>\n";
  for (const RemadeFigure& f : figures) {
    const auto n = count_findings(f);
    page << fmt::format("<tr><td><a href=\"{0}/index.html\">{0}</a></td><td>{1}</td>", escaped(f.spec.name),
                        escaped(f.spec.title));
    static constexpr const char* classes[] = {"yes", "part", "no", "open"};
    for (int k = 0; k < 4; ++k)
      page << (n[k] > 0 ? fmt::format("<td class=\"n\"><span class=\"badge {}\">{}</span></td>", classes[k], n[k])
                        : "<td></td>");
    page << "</tr>\n";
  }
  page << "</table>\n";
  page << list_of(figures, Finding::fails, "Claims that do not hold")
       << list_of(figures, Finding::in_another, "Claims that hold only in another reading")
       << list_of(figures, Finding::unchecked, "What cannot be checked") << "</body></html>\n";
  write_text(file, page.str());
}

}  // namespace talus
