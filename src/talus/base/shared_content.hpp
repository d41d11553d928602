#pragma once
/// Large data that several objects share and none changes.

#include <memory>

namespace talus {

/// Whether two hold the same, be it in one place or in two.
template <class T>
bool same_content(const std::shared_ptr<const T>& a, const std::shared_ptr<const T>& b) {
  return a == b || (a && b && *a == *b);
}

}  // namespace talus
