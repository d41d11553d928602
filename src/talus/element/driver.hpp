#pragma once
/// Drives one law along one loading path.

#include <functional>
#include <string>
#include <vector>

#include "talus/case/loading.hpp"

namespace talus {

/// What an element test reports: named columns with units, compression-positive, and a row an instant.
struct ElementResult {
  std::vector<std::string> names, units, meanings;
  std::vector<std::vector<double>> rows;
  long n_updates = 0;  ///< calls of the law
  long n_unconverged = 0;

  int column(const std::string& name) const;  ///< -1 if there is none
};

/// Runs a test. Throws InputError where the initial state is impossible, RunError where a controlled stress cannot be
/// met.
ElementResult run_element_test(const ElementTest& test);

}  // namespace talus
