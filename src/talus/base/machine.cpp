#include "talus/base/machine.hpp"

#include <sched.h>

#include <algorithm>
#include <ctime>
#include <fstream>
#include <string>
#include <thread>

namespace talus {

namespace {

/// The value of the first line "key : value" of a file.
std::string line_of(const char* path, const std::string& key) {
  std::ifstream file(path);
  for (std::string line; std::getline(file, line);)
    if (line.rfind(key, 0) == 0) {
      const auto colon = line.find(':');
      const auto first = line.find_first_not_of(" \t", colon + 1);
      return first == line.npos ? "" : line.substr(first);
    }
  return "";
}

}  // namespace

std::string version() { return TALUS_VERSION; }

bool same_bits(std::string one_build, std::string other_build) {
  for (std::string* name : {&one_build, &other_build})
    if (const auto at = name->rfind(", x86-64-v4"); at != name->npos) name->back() = '3';
  return one_build == other_build;
}

std::string processor() {
  const std::string name = line_of("/proc/cpuinfo", "model name");
  return name.empty() ? "unknown processor" : name;
}

int n_usable_processors() {
  cpu_set_t usable;
  return ::sched_getaffinity(0, sizeof usable, &usable) == 0 ? std::max(1, CPU_COUNT(&usable)) : n_processors();
}

int n_processors() { return int(std::max(1u, std::thread::hardware_concurrency())); }

double free_memory() {
  const std::string kib = line_of("/proc/meminfo", "MemAvailable");
  return kib.empty() ? 0 : 1024 * std::stod(kib);
}

double cpu_seconds() {
  timespec t;
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return double(t.tv_sec) + 1e-9 * double(t.tv_nsec);
}

}  // namespace talus
