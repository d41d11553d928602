#include "talus/input/make_law.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <set>

#include "talus/base/text.hpp"
#include "talus/input/read_law.hpp"

namespace talus {

namespace {

/// The SI unit of a law's parameter; empty if the law has no such parameter.
std::string unit_of(const std::string& law, const std::string& key) {
  std::string unit;
  Laws::for_each([&]<class Law>() {
    if (!is_named<Law> || Law::name != law) return;
    for (const auto& p : Law::parameters())
      if (p.key == key) unit = std::string(p.unit);
  });
  return unit;
}

/// A text in quotes, with what TOML demands to be escaped.
std::string quoted(const std::string& text) {
  std::string all = "\"";
  for (const char c : text) {
    if (c == '"' || c == '\\') all += '\\';
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f)
      all += fmt::format("\\u{:04x}", int(c));
    else
      all += c;
  }
  return all + '"';
}

std::string as_toml(double value) {
  if (std::isnan(value)) return "nan";
  if (std::isinf(value)) return value > 0 ? "inf" : "-inf";
  const std::string text = fmt::format("{}", value);  // as short as it can be
  return text.find_first_of(".e") == text.npos ? text + ".0" : text;
}

/// The right-hand side of a setting.
std::string value_of(const LawSetting& setting, const std::string& unit) {
  const bool has_unit = !unit.empty() && unit != "1";
  if (const double* number = std::get_if<double>(&setting.value))
    return has_unit && std::isfinite(*number) ? fmt::format("\"{} {}\"", *number, unit) : as_toml(*number);
  const std::string& text = std::get<std::string>(setting.value);
  double number;
  const auto [end, failure] = std::from_chars(text.data(), text.data() + text.size(), number);
  const bool is_number = failure == std::errc() && end == text.data() + text.size();
  return is_number && unit == "1" ? as_toml(number) : quoted(text);
}

}  // namespace

AnyLaw make_law(const std::string& name, const std::vector<LawSetting>& settings) {
  std::vector<Complaint> complaints;
  std::string text = fmt::format("law = {}\n", quoted(name));
  std::set<std::string> keys = {"law"};
  for (const LawSetting& s : settings) {
    if (!keys.insert(s.key).second)
      complaints.push_back({"", 0, 0, fmt::format("`{}` is given twice", printable(s.key))});
    else
      text += fmt::format("{} = {}\n", quoted(s.key), value_of(s, unit_of(name, s.key)));
  }
  static const Declaration declaration("a law", entries_of_laws());
  AnyLaw law;
  try {
    Document document("settings", text);
    Section section = Section::root(document, &declaration);
    law = read_law(section, Preset::standard);
    section.close(fmt::format("law `{}`", printable(name)));
    document.finish();
  } catch (const InputError& e) {
    for (const Complaint& c : e.complaints()) complaints.push_back({"", 0, 0, c.text});
  }
  if (!complaints.empty()) throw InputError(std::move(complaints));
  return law;
}

}  // namespace talus
