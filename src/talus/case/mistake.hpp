#pragma once
/// What is wrong with a case, as data: a reader adds file and line, and C++ gets an InputError.

#include <string>
#include <string_view>
#include <vector>

#include "talus/base/error.hpp"

namespace talus {

/// The keys that lead to a section of an input file: {"solid", "gate", "motion"}.
using SectionPath = std::vector<std::string>;

/// One mistake in a case.
struct Mistake {
  SectionPath section;  ///< empty: the case as a whole
  std::string key;      ///< empty: the section as a whole
  std::string text;     ///< what is wrong with the value, what would be right
};

/// The mistakes in one section, on their way into a list of all.
class MistakesOf {
 public:
  MistakesOf(std::vector<Mistake>& all, SectionPath section) : all_(&all), section_(std::move(section)) {}

  void add(std::string_view key, std::string text) { all_->push_back({section_, std::string(key), std::move(text)}); }
  void add(std::string text) { add("", std::move(text)); }
  /// The mistakes in a section inside this one.
  MistakesOf in(const std::string& key) const {
    MistakesOf inner = *this;
    inner.section_.push_back(key);
    return inner;
  }

 private:
  std::vector<Mistake>* all_;
  SectionPath section_;
};

/// The mistakes of a case that comes from no file.
InputError as_error(const std::vector<Mistake>& mistakes);

}  // namespace talus
