#pragma once
/// The checkpointed state of a simulation in memory.

#include <algorithm>
#include <map>
#include <string>
#include <vector>

#include "talus/mpm/simulation.hpp"

namespace talus {

using SavedState = std::map<std::string, std::vector<double>>;

/// Of a single owner.
inline SavedState in_memory(const std::vector<StateArray>& arrays) {
  SavedState all;
  for (const StateArray& array : arrays) all.emplace(array.name, array.part());
  return all;
}

/// Reads from a state that lives longer.
inline ReadArray reader_of(const SavedState& saved) {
  return [&saved](const std::string& name, std::size_t first, std::size_t n) {
    const std::vector<double>& all = saved.at(name);
    const std::size_t begin = std::min(first, all.size()), end = begin + std::min(n, all.size() - begin);
    return std::vector<double>(all.begin() + std::ptrdiff_t(begin), all.begin() + std::ptrdiff_t(end));
  };
}

}  // namespace talus
