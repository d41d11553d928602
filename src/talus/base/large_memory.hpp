#pragma once
/// Memory of large arrays.

#include <cstddef>
#include <cstdlib>
#include <memory>

namespace talus {

struct FreeMemory {
  void operator()(void* p) const { std::free(p); }
};

/// So many bytes without values, from a cache line on; 2 MB or more in large pages, where the system gives them to those that ask.
/// A processor knows where some thousand pages are: with pages of 4 KB, what nodes and particles hold are more than that.
/// Throws std::bad_alloc.
std::unique_ptr<void, FreeMemory> large_memory(std::size_t bytes);

}  // namespace talus
