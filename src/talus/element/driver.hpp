#pragma once
/// Drives one law along one loading path.

#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "talus/base/table.hpp"
#include "talus/case/loading.hpp"

namespace talus {

/// Result of an element test: named columns with units, compression-positive, and a row for each instant.
struct ElementResult : ResultTable {
  long n_updates = 0;  ///< calls of the law
  long n_unconverged = 0;
  long n_returning = 0;  ///< rows in which collisions return work of shear (see MayReturnWork)
};

/// Runs a test. Throws InputError if the initial state is impossible. A test that needs more than `most_updates` calls of the
/// law ends there, with a message in `failure`.
ElementResult run_element_test(const ElementTest& test, long most_updates = std::numeric_limits<long>::max());

}  // namespace talus
