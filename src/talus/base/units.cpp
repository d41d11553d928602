#include "talus/base/units.hpp"

#include <fmt/format.h>
#include <udunits2.h>

#include <charconv>
#include <cmath>
#include <memory>
#include <mutex>
#include <numbers>
#include <stdexcept>

namespace talus {

namespace {

struct FreeUnit {
  void operator()(ut_unit* u) const { ut_free(u); }
};
using Unit = std::unique_ptr<ut_unit, FreeUnit>;

/// The system of units. UDUNITS is not thread-safe: callers hold `mutex`.
struct UnitSystem {
  std::mutex mutex;
  ut_system* system;

  UnitSystem() {
    ut_set_error_message_handler(ut_ignore);
    system = ut_read_xml(nullptr);
    if (!system) throw std::runtime_error("the table of units of UDUNITS-2 is missing; install libudunits2-0");
    const Unit degree(ut_parse(system, "degree", UT_ASCII));
    ut_map_name_to_unit("deg", UT_ASCII, degree.get());
  }
};
UnitSystem& units() {
  static UnitSystem instance;
  return instance;
}

struct Measure {
  std::string_view unit, name, example;
};
constexpr Measure measures[] = {
    {"m", "a length", "2 mm"},
    {"s", "a time", "0.5 s"},
    {"Pa", "a pressure", "100 kPa"},
    {"rad", "an angle", "20.9 deg"},
    {"m/s", "a velocity", "0.1 m/s"},
    {"m/s2", "an acceleration", "9.81 m/s2"},
    {"kg/m3", "a density", "2500 kg/m3"},
    {"1/s", "a rate", "0.1 1/s"},
    {"1/s2", "an acceleration of strain", "50 1/s2"},
    {"Pa/s", "a rate of pressure", "1 kPa/s"},
    {unit_of_strain, "a strain", "5 %"},
};

/// UDUNITS treats angles as pure numbers and converts one into the other; talus does not.
bool is_angle(const ut_unit* u) {
  char definition[256];
  return ut_format(u, definition, sizeof definition, UT_ASCII | UT_DEFINITION) > 0 &&
         std::string_view(definition).find("rad") != std::string_view::npos;
}

std::string_view trimmed(std::string_view s) {
  while (!s.empty() && std::isspace(static_cast<unsigned char>(s.front()))) s.remove_prefix(1);
  while (!s.empty() && std::isspace(static_cast<unsigned char>(s.back()))) s.remove_suffix(1);
  return s;
}

}  // namespace

std::variant<double, std::string> to_si(std::string_view text, std::string_view unit) {
  const std::string expected = "not " + what_is_measured_in(unit) + "; write " + example_of(unit);
  std::string_view rest = trimmed(text);
  if (!rest.empty() && rest.front() == '+') rest.remove_prefix(1);
  double number = 0;
  const auto parsed = std::from_chars(rest.data(), rest.data() + rest.size(), number);
  if (parsed.ec != std::errc() || !std::isfinite(number)) return expected;
  rest = trimmed(rest.substr(parsed.ptr - rest.data()));
  if (unit == unit_of_strain) {
    if (rest == "%") return number / 100;
    return expected;
  }
  if (rest.empty()) return "lacks its unit; write " + example_of(unit);

  // UDUNITS accepts more than units: factors ("3 mm 2" would be 6 mm), powers of 0 ("3 mm0 mm" would be 3 mm).
  for (std::size_t i = rest.substr(0, 2) == "1/" ? 1 : 0; i < rest.size(); ++i) {
    const auto digit = [&](std::size_t at) { return std::isdigit(static_cast<unsigned char>(rest[at])) != 0; };
    if (!digit(i)) continue;
    const bool is_power = i > 0 && (std::isalpha(static_cast<unsigned char>(rest[i - 1])) || rest[i - 1] == '^' ||
                                    rest[i - 1] == '-' || (digit(i - 1) && i > 1));
    if (!is_power || (rest[i] == '0' && !digit(i - 1))) return expected;
  }
  constexpr std::size_t longest = 40;
  if (rest.size() > longest) return fmt::format("has a unit longer than {} characters", longest);

  UnitSystem& u = units();
  const std::lock_guard lock(u.mutex);
  const Unit given(ut_parse(u.system, std::string(rest).c_str(), UT_UTF8));
  if (!given) return fmt::format("has the unknown unit `{}`; write {}", rest, example_of(unit));
  const Unit wanted(ut_parse(u.system, std::string(unit).c_str(), UT_UTF8));
  // UDUNITS also converts a unit into its reciprocal, seconds into hertz; so the quotient must be a pure number.
  const Unit quotient(ut_divide(given.get(), wanted.get()));
  if (!quotient || !ut_is_dimensionless(quotient.get()) || !ut_are_convertible(given.get(), wanted.get()) ||
      is_angle(given.get()) != is_angle(wanted.get()))
    return expected;
  cv_converter* converter = ut_get_converter(given.get(), wanted.get());
  const double si = cv_convert_double(converter, number);
  cv_free(converter);
  if (!std::isfinite(si)) return expected;
  return si;
}

std::string what_is_measured_in(std::string_view unit) {
  for (const Measure& m : measures)
    if (m.unit == unit) return std::string(m.name);
  return fmt::format("a quantity in {}", unit);
}

std::string with_unit(double value, std::string_view unit) {
  if (unit == "1" || unit == unit_of_strain) return fmt::format("{:.10g}", value);
  if (unit == "rad") return fmt::format("{:.10g} deg", value * 180 / std::numbers::pi);
  if (unit == "m" && value != 0 && std::abs(value) < 1) return fmt::format("{:.10g} mm", value * 1e3);
  if (unit == "Pa" && std::abs(value) >= 1e9) return fmt::format("{:.10g} GPa", value / 1e9);
  if (unit == "Pa" && std::abs(value) >= 1e3) return fmt::format("{:.10g} kPa", value / 1e3);
  if (unit == "s" && value != 0 && std::abs(value) < 1) return fmt::format("{:.10g} ms", value * 1e3);
  return fmt::format("{:.10g} {}", value, unit);
}

LengthUnit length_unit_for(double size) {
  return size < 2 ? LengthUnit{"mm", 1e-3} : size < 5e3 ? LengthUnit{"m", 1} : LengthUnit{"km", 1e3};
}

std::string example_of(std::string_view unit) {
  for (const Measure& m : measures)
    if (m.unit == unit) return fmt::format("\"{}\"", m.example);
  return fmt::format("\"1 {}\"", unit);
}

std::string in_words(const Range& range, std::string_view unit) {
  const bool low = std::isfinite(range.low), high = std::isfinite(range.high);
  const std::string a = with_unit(range.low, unit), b = with_unit(range.high, unit);
  if (low && high && !range.open_low && !range.open_high) return fmt::format("between {} and {}", a, b);
  std::string text;
  if (low) text = fmt::format("{} {}", range.open_low ? "greater than" : "at least", a);
  if (low && high) text += " and ";
  if (high) text += fmt::format("{} {}", range.open_high ? "less than" : "at most", b);
  return text.empty() ? "any number" : text;
}

}  // namespace talus
