#include "talus/case/defaults.hpp"
#include "talus/case/keys.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

std::optional<std::vector<double>> read_pictures(Section& s, const Case& case_) {
  if (!s.has("pictures")) {
    s.note("pictures", "six instants from the start to the end", keys::pictures(case_.end).meaning);
    return std::nullopt;
  }
  std::vector<double> instants = s.numbers(keys::pictures(case_.end), 0);
  return s.is_right() ? std::optional(instants) : std::nullopt;
}

}  // namespace

void read_output(Section& root, Case& case_) {
  Section s = root.has("output") ? root.section("output", "what is written") : Section::empty(root, "output");
  OutputSpec& o = case_.output;
  const auto number = [&](const Parameter& p, const Default& by_default) {
    return s.number(p, by_default.value, by_default.reason);
  };
  o.snapshots = number(keys::snapshots, default_snapshots(case_));
  o.history = number(keys::history, default_history(case_));
  o.front_thickness = number(keys::front_thickness, default_front_thickness(case_));
  o.pictures = read_pictures(s, case_);
  const std::vector<std::string> usual = default_fields(case_);
  o.fields = s.words("fields", known_fields(case_), {usual.begin(), usual.end()}, "quantities in snapshots");
  o.checkpoints = s.optional_number(keys::checkpoints);
  o.checkpoint_wall = s.number(keys::checkpoint_wall, o.checkpoint_wall);
  s.close("[output]");
}

}  // namespace talus
