#pragma once
/// Ctrl-C and SIGTERM.

namespace talus {

/// While it lives, the first Ctrl-C (SIGINT) or SIGTERM is only noted, and the next one ends the program at once. What
/// was ignored before, as in the background of a script, stays so.
class Interrupt {
 public:
  Interrupt();
  ~Interrupt();
  Interrupt(const Interrupt&) = delete;
  Interrupt& operator=(const Interrupt&) = delete;

  /// Number of the signal that came; 0 if none did.
  int signal() const;
};

}  // namespace talus
