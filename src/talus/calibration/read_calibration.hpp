#pragma once
/// Reads a calibration: the law, the parameters to find, and the measured tests.

#include <string>
#include <string_view>

#include "talus/calibration/specification.hpp"
#include "talus/input/declaration.hpp"

namespace talus {

const Declaration& calibration_declaration();

/// Reads and checks a file and the tables it names. Throws InputError with every mistake at once.
Calibration read_calibration(const std::string& path);
/// The same from a text; `name` stands for the file in messages, `folder` is where tables are looked for.
Calibration read_calibration_text(const std::string& name, std::string_view text, const std::string& folder);

}  // namespace talus
