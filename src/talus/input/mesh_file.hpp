#pragma once
/// Surfaces of triangles from files.

#include <cstdint>
#include <string>
#include <vector>

#include "talus/math/vec.hpp"

namespace talus {

/// Bytes of a file of triangles that are read at most: ten million triangles.
inline constexpr std::uintmax_t most_mesh_bytes = std::uintmax_t(512) << 20;

/// The corners of the triangles of an STL, ASCII or binary, three each, in m. Coordinates of an STL are numbers of seven
/// digits; each is taken for the shortest decimal number that it stands for, so that 0.1 is 0.1. Throws
/// std::runtime_error with one sentence.
std::vector<Vec<3>> read_stl(const std::string& path, double metres_per_unit);

}  // namespace talus
