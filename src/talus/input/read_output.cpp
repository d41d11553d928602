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
constexpr Option size_of_report{"report", "size of report.html", report_choices};
constexpr Words fields{"fields", "quantities in snapshots", all_fields};

std::optional<std::vector<double>> read_pictures(Section& s, const Case& case_) {
  if (!s.has("pictures")) {
    s.note("pictures", "six instants from the start to the end", keys::pictures(case_.end).meaning);
    return std::nullopt;
  }
  std::vector<double> instants = s.numbers(keys::pictures(case_.end), 0);
  return s.is_right() ? std::optional(instants) : std::nullopt;
}

const Declaration& maps_declaration() {
  static const Declaration d("maps", {optional(keys::map_pixel), optional(keys::map_interval),
                                      optional(keys::least_thickness), optional(keys::map_frames)});
  return d;
}
constexpr Table maps_table{"maps", "maps of a run on terrain", maps_declaration};

void read_maps(Section& output, Case& case_) {
  if (!case_.map) {
    if (output.has("maps")) output.complain("maps", "goes with a [terrain] only");
    return;
  }
  Section s = output.optional_section(maps_table);
  MapSpec& maps = case_.output.maps;
  const auto number = [&](const Parameter& p, const Default& by_default) {
    return s.number(p, by_default.value, by_default.reason);
  };
  maps.pixel = number(keys::map_pixel, default_map_pixel(case_));
  maps.interval = number(keys::map_interval, default_map_interval(case_));
  maps.least_thickness = number(keys::least_thickness, default_least_thickness(case_));
  maps.frames = number(keys::map_frames, default_map_frames(case_));
  s.close();
}

}  // namespace

const Declaration& output_declaration() {
  static const Declaration d(
      "[output]",
      {optional(keys::snapshots), optional(keys::history), optional(keys::peak_force_time),
       optional(keys::front_thickness), optional(Numbers{keys::pictures(0)}), optional(fields),
       optional(keys::checkpoints), optional(keys::checkpoint_wall), optional(size_of_report), optional(maps_table)});
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
  o.peak_force_time = number(keys::peak_force_time, default_peak_force_time(case_));
  o.front_thickness = number(keys::front_thickness, default_front_thickness(case_));
  o.pictures = read_pictures(s, case_);
  const std::vector<std::string> usual = default_fields(case_);
  o.fields = s.words(fields.key, known_fields(case_), {usual.begin(), usual.end()}, fields.meaning);
  read_maps(s, case_);
  o.checkpoints = s.optional_number(keys::checkpoints);
  o.checkpoint_wall = s.number(keys::checkpoint_wall, o.checkpoint_wall);
  o.report = ReportSize(s.choice(size_of_report));
  s.close();
}

}  // namespace talus
