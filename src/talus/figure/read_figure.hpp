#pragma once
/// Reads figure.toml. validation/README.md has the format.

#include <string>

#include "talus/figure/specification.hpp"

namespace talus {

/// Reads FOLDER/figure.toml, and the tests and cases it names. Throws InputError with every mistake at once.
FigureSpec read_figure(const std::string& folder);

}  // namespace talus
