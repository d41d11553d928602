#pragma once
/// Drives one law along one loading path.

#include <functional>
#include <string>
#include <vector>

#include "talus/base/table.hpp"
#include "talus/case/loading.hpp"

namespace talus {

/// What an element test reports: named columns with units, compression-positive, and a row an instant.
struct ElementResult : NumberTable {
  std::vector<std::string> units, meanings;  ///< of the columns
  long n_updates = 0;                        ///< calls of the law
  long n_unconverged = 0;
  std::string failure;  ///< empty, or why the test ended before its end: a controlled stress that cannot be met
};

/// The result as a CSV file, units in the header.
std::string as_csv(const ElementResult& result);

/// Runs a test. Throws InputError where the initial state is impossible.
ElementResult run_element_test(const ElementTest& test);

}  // namespace talus
