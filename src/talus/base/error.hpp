#pragma once
/// What can go wrong: the user's input, which the user can mend, or the run.

#include <optional>
#include <stdexcept>
#include <string>
#include <vector>

namespace talus {

/// One mistake in an input file. `line` and `column` count from 1; 0 where the file as a whole is meant.
struct Complaint {
  std::string file;
  int line = 0, column = 0;
  std::string text;  ///< the key, what is wrong with it, what would be right

  std::string to_string() const;
};

/// The input is not right; all complaints at once, in file order.
class InputError : public std::runtime_error {
 public:
  explicit InputError(std::vector<Complaint> complaints);
  explicit InputError(const std::string& text) : InputError(std::vector<Complaint>{{"", 0, 0, text}}) {}
  const std::vector<Complaint>& complaints() const { return complaints_; }

 private:
  std::vector<Complaint> complaints_;
};

/// The run broke: what happened, to which particle, where, when and in what state.
class RunError : public std::runtime_error {
 public:
  /// `particle`: the number of the one where it showed, if it is known.
  explicit RunError(const std::string& text, std::optional<long> particle = {})
      : std::runtime_error(text), particle_(particle) {}
  std::optional<long> particle() const { return particle_; }

 private:
  std::optional<long> particle_;
};

}  // namespace talus
