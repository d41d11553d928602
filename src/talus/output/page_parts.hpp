#pragma once
/// Files that pages are made of, as bytes in the program: our own in report/, and libraries of others from the system,
/// with their licences in report/licences.html.

#include <string_view>

namespace talus::page_parts {

std::string_view player_js();
std::string_view viewer_html();
std::string_view viewer_js();
std::string_view map_html();
std::string_view map_js();
std::string_view curves_js();
std::string_view report_css();
std::string_view licences_html();
std::string_view three_js();
std::string_view orbit_controls_js();
std::string_view dygraph_js();
std::string_view dygraph_css();

}  // namespace talus::page_parts
