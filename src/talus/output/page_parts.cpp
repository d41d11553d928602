#include "talus/output/page_parts.hpp"

#include <cstddef>

// The build defines the folders: TALUS_REPORT is report/ beside this file, TALUS_THREE and TALUS_DYGRAPHS are the
// libraries' own. The assembler includes the bytes.
#define TALUS_PART(name, file)                                                                                        \
  asm(".pushsection .rodata\ntalus_part_" #name ":\n.incbin \"" file "\"\ntalus_part_" #name "_end:\n.popsection\n"); \
  extern "C" const char talus_part_##name[], talus_part_##name##_end[];                                               \
  std::string_view name() { return {talus_part_##name, std::size_t(talus_part_##name##_end - talus_part_##name)}; }

namespace talus::page_parts {

TALUS_PART(player_js, TALUS_REPORT "/player.js")
TALUS_PART(viewer_html, TALUS_REPORT "/viewer.html")
TALUS_PART(viewer_js, TALUS_REPORT "/viewer.js")
TALUS_PART(map_html, TALUS_REPORT "/map.html")
TALUS_PART(map_js, TALUS_REPORT "/map.js")
TALUS_PART(curves_js, TALUS_REPORT "/curves.js")
TALUS_PART(report_css, TALUS_REPORT "/report.css")
TALUS_PART(licences_html, TALUS_REPORT "/licences.html")
TALUS_PART(three_js, TALUS_THREE "/three.min.js")
TALUS_PART(orbit_controls_js, TALUS_THREE "/examples/js/controls/OrbitControls.js")
TALUS_PART(dygraph_js, TALUS_DYGRAPHS "/dygraph.min.js")
TALUS_PART(dygraph_css, TALUS_DYGRAPHS "/dygraph.min.css")

}  // namespace talus::page_parts
