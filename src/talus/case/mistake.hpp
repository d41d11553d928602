#pragma once
/// Errors in a case, as data: a reader adds file and line; C++ gets an InputError.

#include <string>
#include <string_view>
#include <vector>

#include "talus/base/error.hpp"

namespace talus {

/// Path of keys to a section of an input file: {"solid", "gate", "motion"}.
using SectionPath = std::vector<std::string>;

/// One error in a case.
struct Mistake {
  SectionPath section;  ///< empty: the case as a whole
  std::string key;      ///< empty: the section as a whole
  std::string text;     ///< what is wrong with the value, what to write
};

/// Adds errors in one section to a list of all errors.
class MistakesOf {
 public:
  MistakesOf(std::vector<Mistake>& all, SectionPath section) : all_(&all), section_(std::move(section)) {}

  void add(std::string_view key, std::string text) { all_->push_back({section_, std::string(key), std::move(text)}); }
  void add(std::string text) { add("", std::move(text)); }
  /// The same for a section inside this one.
  MistakesOf in(const std::string& key) const {
    MistakesOf inner = *this;
    inner.section_.push_back(key);
    return inner;
  }

 private:
  std::vector<Mistake>* all_;
  SectionPath section_;
};

/// Errors of a case that was not read from a file, as an exception.
InputError as_error(const std::vector<Mistake>& mistakes);

}  // namespace talus
