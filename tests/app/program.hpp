#pragma once
/// Runs talus as its users do.

#include <fcntl.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <string>
#include <thread>
#include <vector>

namespace program {

struct Finished {
  int code;            ///< -1 if a signal ended it
  std::string output;  ///< both streams
};
inline Finished talus(const std::string& arguments, const std::string& environment = "") {
  FILE* pipe = ::popen((environment + " " TALUS_PROGRAM " " + arguments + " 2>&1").c_str(), "r");
  std::string output;
  std::array<char, 4096> buffer;
  for (std::size_t n; (n = std::fread(buffer.data(), 1, buffer.size(), pipe)) > 0;) output.append(buffer.data(), n);
  const int status = ::pclose(pipe);
  return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, output};
}
inline bool has(const std::string& text, const std::string& part) { return text.find(part) != std::string::npos; }
inline std::string replaced(std::string text, const std::string& part, const std::string& by) {
  const std::size_t at = text.find(part);
  EXPECT_NE(at, text.npos) << part;
  return text.replace(at, part.size(), by);
}
inline std::string contents(const std::filesystem::path& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

/// talus at work in the background, to be sent signals.
class Running {
 public:
  /// Both streams go to the file `log`.
  Running(const std::vector<std::string>& arguments, std::filesystem::path log) : log_(std::move(log)) {
    std::vector<char*> argv{const_cast<char*>(TALUS_PROGRAM)};
    for (const std::string& a : arguments) argv.push_back(const_cast<char*>(a.c_str()));
    argv.push_back(nullptr);
    pid_ = ::fork();
    if (pid_ != 0) return;
    const int out = ::open(log_.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0644);
    ::dup2(out, 1);
    ::dup2(out, 2);
    ::execv(TALUS_PROGRAM, argv.data());
    ::_exit(127);
  }
  ~Running() {
    if (pid_ <= 0) return;
    send(SIGKILL);
    wait();
  }
  Running(const Running&) = delete;
  Running& operator=(const Running&) = delete;

  void send(int signal) const { ::kill(pid_, signal); }
  /// Waits for its end.
  Finished wait() {
    int status = 0;
    ::waitpid(pid_, &status, 0);
    pid_ = 0;
    return {WIFEXITED(status) ? WEXITSTATUS(status) : -1, contents(log_)};
  }
  /// Waits until a file is there that has at least so many bytes.
  void wait_for(const std::filesystem::path& file, std::uintmax_t bytes) const {
    std::error_code missing;
    for (int i = 0; i < 60000; ++i) {
      const std::uintmax_t size = std::filesystem::file_size(file, missing);
      if (!missing && size >= bytes) return;
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
  }

 private:
  pid_t pid_ = 0;
  std::filesystem::path log_;
};

}  // namespace program
