#include "talus/app/progress.hpp"

#include <fmt/format.h>
#include <unistd.h>

#include <cmath>
#include <cstdio>

#include "talus/app/terminal.hpp"

namespace talus {

/// Back to the start of the terminal's line, and clear it.
constexpr const char* to_line_start = "\r\033[K";

std::string duration_in_words(double seconds) {
  if (!std::isfinite(seconds)) return "?";
  const long s = std::lround(seconds);
  if (s < 60) return fmt::format("{} s", s);
  if (s < 3600) return fmt::format("{}:{:02} min", s / 60, s % 60);
  return fmt::format("{}:{:02} h", s / 3600, s / 60 % 60);
}

Progress::Progress(double end, const Ledger& from)
    : end_(end),
      from_time_(from.time),
      from_step_(from.step),
      live_(isatty(STDERR_FILENO)),
      start_(std::chrono::steady_clock::now()),
      last_shown_(start_) {}

double Progress::seconds() const {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start_).count();
}

double Progress::speed(const Ledger& ledger, long n_particles) const {
  return 1e-6 * double(n_particles) * double(ledger.step - from_step_) / std::max(seconds(), 1e-9);
}

std::string Progress::line(const Ledger& l, long n_particles) const {
  const double done = l.time - from_time_, left = done > 0 ? seconds() * (end_ - l.time) / done : INFINITY;
  return fmt::format("t = {:.4f} of {:.4g} s   step {}   {:.3g} M particle-steps/s   {} left", l.time, end_, l.step,
                     speed(l, n_particles), duration_in_words(std::max(0.0, left)));
}

std::string Progress::live_line(const Ledger& l, long n_particles) const {
  const std::size_t columns = columns_of_stderr();
  std::string whole = line(l, n_particles);
  if (whole.size() < columns) return whole;
  const double done = l.time - from_time_, left = done > 0 ? seconds() * (end_ - l.time) / done : INFINITY;
  const std::string brief =
      fmt::format("t = {:.3g} of {:.3g} s, {} left", l.time, end_, duration_in_words(std::max(0.0, left)));
  return brief.substr(0, columns - 1);
}

void Progress::show(const Ledger& ledger, long n_particles) {
  const auto now = std::chrono::steady_clock::now();
  const double since = std::chrono::duration<double>(now - last_shown_).count();
  // A terminal is refreshed five times a second; a log gets a line every tenth minute at most, sooner in short runs.
  if (since < (live_ ? 0.2 : std::clamp(seconds() / 4, 5.0, 600.0))) return;
  last_shown_ = now;
  if (live_)
    fmt::print(stderr, "{}{}", to_line_start, live_line(ledger, n_particles));
  else
    fmt::print(stderr, "{}\n", line(ledger, n_particles));
  std::fflush(stderr);
}

void Progress::finish(const Ledger& ledger, long n_particles) {
  if (live_) fmt::print(stderr, "{}", to_line_start);
  say("t = {:.4f} s   {} steps   {:.3g} M particle-steps/s   took {}\n", ledger.time, ledger.step,
      speed(ledger, n_particles), duration_in_words(seconds()));
}

}  // namespace talus
