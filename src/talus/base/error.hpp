#pragma once
/// Exceptions: errors in the input of the user, and failures of a run.

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace talus {

/// One error in an input file. `line` and `column` count from 1; 0 stands for the whole file.
struct Complaint {
  std::string file;
  int line = 0, column = 0;
  std::string text;  ///< the key, what is wrong with its value, what to write

  std::string to_string() const;
};

/// Errors in the input, all of them, in file order.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Complaint> complaints);
  explicit InputError(const std::string& text) : InputError(std::vector<Complaint>{{"", 0, 0, text}}) {}
  const std::vector<Complaint>& complaints() const { return complaints_; }

 private:
  std::vector<Complaint> complaints_;
};

/// A run has failed. The message gives the cause, the particle, its position, the time and its state.
class RunError : public std::runtime_error {
 public:
  /// `particle`: number of the particle at which the failure was found, if known.
  explicit RunError(const std::string& text, std::optional<long> particle = {})
      : std::runtime_error(text), particle_(particle) {}
  std::optional<long> particle() const { return particle_; }

 private:
  std::optional<long> particle_;
};

}  // namespace talus
