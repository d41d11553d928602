#include "talus/app/memory_limit.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <csignal>
#include <cstring>

#include "talus/app/commands.hpp"

namespace talus {

namespace {

/// Calls only what a signal handler may call.
void end_out_of_memory(int) {
  for (const char* part : {"talus: ", out_of_memory, "\n"})
    if (::write(STDERR_FILENO, part, std::strlen(part)) < 0) break;
  ::_exit(exit_failed);
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
  action.sa_handler = end_out_of_memory;
  action.sa_flags = SA_ONSTACK;
  ::sigaction(SIGSEGV, &action, nullptr);
}

}  // namespace talus
