#pragma once
/// The surface of the material at some instants, as a drawing for the report.

#include <filesystem>
#include <string>

namespace talus {

/// Profiles of the thickness at up to seven instants of a file of ProfileTable, from the first to the last, as HTML with an SVG;
/// empty if the file has no two instants. `extent` [m]: size of the domain, for the unit of lengths.
std::string surface_profiles(const std::filesystem::path& surface, double extent);

}  // namespace talus
