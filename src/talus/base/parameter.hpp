#pragma once
/// Settings of the user. Reader, range check, suggestions, help and documents use the same description.

#include <functional>
#include <limits>
#include <span>
#include <string_view>
#include <vector>

namespace talus {

/// Permitted range of a number; an open end excludes its bound.
struct Range {
  double low = -std::numeric_limits<double>::infinity();
  double high = std::numeric_limits<double>::infinity();
  bool open_low = false;
  bool open_high = false;

  constexpr bool contains(double x) const {
    return (open_low ? x > low : x >= low) && (open_high ? x < high : x <= high);
  }
  static constexpr Range positive() { return {.low = 0, .open_low = true}; }
  static constexpr Range not_negative() { return {.low = 0}; }
  static constexpr Range between(double a, double b) { return {.low = a, .high = b}; }
  static constexpr Range inside(double a, double b) {
    return {.low = a, .high = b, .open_low = true, .open_high = true};
  }
};

/// A number the user sets: `unit` is its SI unit ("1" for a bare number), `range` is in that unit.
struct Parameter {
  std::string_view key;
  std::string_view unit;
  Range range;
  std::string_view meaning;
};

/// One of the words an option takes.
struct Choice {
  std::string_view word;
  std::string_view meaning;
};

/// A word the user may set; the first choice is the default.
struct Option {
  std::string_view key;
  std::string_view meaning;
  std::span<const Choice> choices;
};

/// A parameter and the member of T that holds it.
template <class T>
struct ParameterOf : Parameter {
  std::function<double&(T&)> value;
};

/// An option and the member of T that holds the number of its choice.
template <class T>
struct OptionOf : Option {
  std::function<void(T&, int choice)> set;
  std::function<int(const T&)> get;
};

/// The parameters of a member as parameters of the object that contains it.
template <class Whole, class Part>
std::vector<ParameterOf<Whole>> lifted(std::span<const ParameterOf<Part>> table, Part Whole::*part) {
  std::vector<ParameterOf<Whole>> whole;
  for (const auto& p : table) whole.push_back({p, [&p, part](Whole& w) -> double& { return p.value(w.*part); }});
  return whole;
}
template <class Whole, class Part>
std::vector<OptionOf<Whole>> lifted(std::span<const OptionOf<Part>> table, Part Whole::*part) {
  std::vector<OptionOf<Whole>> whole;
  for (const auto& o : table)
    whole.push_back({o, [&o, part](Whole& w, int choice) { o.set(w.*part, choice); },
                     [&o, part](const Whole& w) { return o.get(w.*part); }});
  return whole;
}

}  // namespace talus
