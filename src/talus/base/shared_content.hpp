#pragma once
/// Large constant data shared by several objects.

#include <memory>

namespace talus {

/// Compares the contents, also of two separate copies.
template <class T>
bool same_content(const std::shared_ptr<const T>& a, const std::shared_ptr<const T>& b) {
  return a == b || (a && b && *a == *b);
}

}  // namespace talus
