#include <fmt/format.h>
#include <spawn.h>
#include <sys/wait.h>

#include <cstdlib>
#include <filesystem>

#include "talus/app/commands.hpp"
#include "talus/base/error.hpp"

extern char** environ;

namespace talus {

namespace {

bool has_display() {
  for (const char* name : {"DISPLAY", "WAYLAND_DISPLAY"})
    if (const char* value = std::getenv(name); value && *value) return true;
  return false;
}

/// Opens a file with the default program of the desktop. False if there is none.
bool open_on_desktop(std::string file) {
  std::string program = "xdg-open";
  char* arguments[] = {program.data(), file.data(), nullptr};
  pid_t child = 0;
  if (posix_spawnp(&child, "xdg-open", nullptr, nullptr, arguments, environ) != 0) return false;
  int status = 0;
  return waitpid(child, &status, 0) == child && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

int view_report(const std::string& folder) {
  const std::filesystem::path report = std::filesystem::absolute(folder) / "report.html";
  if (!std::filesystem::exists(folder)) throw InputError(fmt::format("{}: there is no such folder", folder));
  if (!std::filesystem::exists(report))
    throw InputError(
        fmt::format("{} holds no report.html; `talus run` writes it into its folder when a run ends", folder));
  if (has_display() && open_on_desktop(report.string()))
    fmt::print("opened {}\n", report.string());
  else
    fmt::print("{}\n", report.string());
  return 0;
}

}  // namespace talus
