#pragma once
/// Ctrl-C and SIGTERM.

namespace talus {

/// While it lives, the first Ctrl-C (SIGINT) or SIGTERM is only recorded, and the next one ends the program at once. Signals
/// that were ignored before, as in the background of a script, stay ignored.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// Number of the signal that was received; 0 without one.
  int signal() const;
};

}  // namespace talus
