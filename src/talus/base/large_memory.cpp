#include "talus/base/large_memory.hpp"

#include <sys/mman.h>

#include <new>

namespace talus {

std::unique_ptr<void, FreeMemory> large_memory(std::size_t bytes) {
  constexpr std::size_t line = 64, large_page = std::size_t(1) << 21;
  const bool is_large = bytes >= large_page;
  void* p = nullptr;
  if (posix_memalign(&p, is_large ? large_page : line, bytes) != 0) throw std::bad_alloc();
  if (is_large) madvise(p, bytes, MADV_HUGEPAGE);  // a request that may be refused
  return std::unique_ptr<void, FreeMemory>(p);
}

}  // namespace talus
