#include "talus/app/memory_limit.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <cstring>

#include "talus/app/commands.hpp"

namespace talus {

namespace {

/// Calls only what a signal handler may call.
[[noreturn]] void end_out_of_memory() {
  for (const char* part : {"talus: ", out_of_memory, "\n"})
    if (::write(STDERR_FILENO, part, std::strlen(part)) < 0) break;
  ::_exit(exit_failed);
}

void at_invalid_access(int) { end_out_of_memory(); }

/// HDF5 leaves with -1. The program itself returns from main, and never with that.
void at_exit(int code, void*) {
  if (code == -1) end_out_of_memory();
}

}  // namespace

void report_out_of_memory_in_libraries() {
  rlimit limit{};
  if (::getrlimit(RLIMIT_AS, &limit) != 0 || limit.rlim_cur == RLIM_INFINITY) return;
  static char stack[16384];  // the program's own may be what cannot grow
  stack_t other{};
  other.ss_sp = stack;
  other.ss_size = sizeof stack;
  ::sigaltstack(&other, nullptr);
  struct sigaction action {};
  action.sa_handler = at_invalid_access;
  action.sa_flags = SA_ONSTACK;
  ::sigaction(SIGSEGV, &action, nullptr);
  ::on_exit(at_exit, nullptr);
}

}  // namespace talus
