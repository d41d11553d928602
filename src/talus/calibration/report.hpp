#pragma once
/// Files of a finished calibration.

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "talus/calibration/calibrate.hpp"

namespace talus {

/// The material block of an input file, with standard errors as comments.
std::string material_block(const Calibration& calibration, const CalibrationResult& result);
/// The same parameters as constants of a user material for Abaqus, SI, in the order of the law's table.
std::string user_material(const Calibration& calibration, const CalibrationResult& result);
/// Everything that was found, as JSON.
std::string result_as_json(const Calibration& calibration, const CalibrationResult& result);
/// The table of parameters and the findings, for the terminal.
std::string result_in_words(const Calibration& calibration, const CalibrationResult& result);

/// Mean misfit of a quantity over the tests of a kind.
struct MeanMisfit {
  std::string kind, quantity;
  double start, fitted;
  int n_tests;
  bool is_fitted;  ///< its weight is above 0 in some test
};
std::vector<MeanMisfit> mean_misfits(const Calibration& calibration, const CalibrationResult& result);

/// Misfit of a test that was left out: of the parameters fitted to all tests, and of those fitted without its group.
struct LeftOutMisfit {
  double with, without;
};
/// None if the test was not left out.
std::optional<LeftOutMisfit> left_out_misfit(const CalibrationResult& result, std::size_t test);

/// Writes material.toml, user_material.inp, result.json, the tables as CSV, a picture for each test with its data and
/// script, and the page index.html. False if there is no gnuplot.
bool write_report(const std::filesystem::path& folder, const Calibration& calibration, const CalibrationResult& result);

}  // namespace talus
