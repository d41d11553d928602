#pragma once
/// The page of a calibration, with a picture for each test.

#include <filesystem>
#include <string>

#include "talus/calibration/calibrate.hpp"

namespace talus {

/// Draws every test, measured and computed: tests/NAME.svg in `folder`, with its data (.dat), and one script for all
/// (tests/draw.gp). False if there is no gnuplot.
bool draw_tests(const std::filesystem::path& folder, const Calibration& calibration, const CalibrationResult& result);

/// The page; pictures in `folder` are part of it.
std::string calibration_page(const std::filesystem::path& folder, const Calibration& calibration,
                             const CalibrationResult& result, bool drawn);

/// "A test ... would reduce the standard error of ... to 20 %."
std::string suggestion_in_words(const Calibration& calibration, const Suggestion& suggestion);

}  // namespace talus
