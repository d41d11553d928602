#include <algorithm>

#include "talus/case/defaults.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

/// Quantities of every law.
const std::vector<std::string_view>& all_fields() {
  static const std::vector<std::string_view> fields = [] {
    std::vector<std::string_view> all;
    const auto add = [&](std::string_view name) {
      if (std::find(all.begin(), all.end(), name) == all.end()) all.push_back(name);
    };
    for (const Quantity& q : common_quantities) add(q.name);
    Laws::for_each([&]<class Law>() {
      for (const auto& q : Law::quantities()) add(q.name);
    });
    return all;
  }();
  return fields;
}
constexpr Words fields{"fields", "quantities in snapshots", all_fields};

std::optional<std::vector<double>> read_pictures(Section& s, const Case& case_) {
  if (!s.has("pictures")) {
    s.note("pictures", "six instants from the start to the end", keys::pictures(case_.end).meaning);
    return std::nullopt;
  }
  std::vector<double> instants = s.numbers(keys::pictures(case_.end), 0);
  return s.is_right() ? std::optional(instants) : std::nullopt;
}

}  // namespace

const Declaration& output_declaration() {
  static const Declaration d("[output]",
                             {optional(keys::snapshots), optional(keys::history), optional(keys::front_thickness),
                              optional(Numbers{keys::pictures(0)}), optional(fields), optional(keys::checkpoints),
                              optional(keys::checkpoint_wall)});
  return d;
}

void read_output(Section& root, Case& case_) {
  Section s = root.optional_section(keys::output);
  OutputSpec& o = case_.output;
  const auto number = [&](const Parameter& p, const Default& by_default) {
    return s.number(p, by_default.value, by_default.reason);
  };
  o.snapshots = number(keys::snapshots, default_snapshots(case_));
  o.history = number(keys::history, default_history(case_));
  o.front_thickness = number(keys::front_thickness, default_front_thickness(case_));
  o.pictures = read_pictures(s, case_);
  const std::vector<std::string> usual = default_fields(case_);
  o.fields = s.words(fields.key, known_fields(case_), {usual.begin(), usual.end()}, fields.meaning);
  o.checkpoints = s.optional_number(keys::checkpoints);
  o.checkpoint_wall = s.number(keys::checkpoint_wall, o.checkpoint_wall);
  s.close();
}

}  // namespace talus
