#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <stdexcept>

#include "talus/base/table.hpp"
#include "talus/base/text.hpp"
#include "talus/case/check.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr Parameter start_of_motion{"from", "s", Range::not_negative(), "instant at which it starts"},
    end_of_motion{"until", "s", Range::positive(), "instant at which it stops"};

constexpr Numbers centre_of_turn{{"centre", "m", {}, "a point on the axis of rotation, at the start"}, one_per_axis},
    axis_of_turn{{"axis", "1", {}, "axis of the right-handed rotation"}, 3},
    times_of_angles{{"times", "s", Range::not_negative(), "instants at which angles are given"}},
    angles{{"angles", "rad", {}, "angles of rotation at these instants"}};
constexpr Parameter rate_of_turn{"rate", "rad/s", {}, "rate of rotation; in plane strain positive from x to y"};
const Declaration& rotation_declaration() {
  static const Declaration d(
      "a rotation",
      {required(centre_of_turn), depends(axis_of_turn), optional(rate_of_turn), optional(start_of_motion),
       optional(end_of_motion), depends(times_of_angles), optional(angles)},
      {"rate", "angles"});
  return d;
}

constexpr Table rotation{"rotation", "how the solid turns", rotation_declaration};
constexpr Numbers velocity_of_solid{{"velocity", "m/s", {}, "velocity of the solid"}, one_per_axis},
    times{{"times", "s", Range::not_negative(), "instants at which displacements are given"}};
constexpr Points displacements{{"displacements", "m", {}, "displacements since the start at these instants"},
                               one_per_axis};
constexpr Text file_of_motion{"file", "CSV file of the motion, with columns time [s], x, y and in 3D z [m]"};

/// A change at a constant rate from an instant until another.
template <class T>
LinearInTime<T> read_constant_rate(Section& s, const T& rate) {
  const double start = s.number(start_of_motion, 0.0);
  const std::optional<double> end = s.optional_number(end_of_motion);
  if (end && !(*end > start)) {
    s.complain("until", "must be later than `from`");
    return constant_rate(rate, start);
  }
  return constant_rate(rate, start, end);
}

/// The columns of a file as a displacement. Throws std::runtime_error with what is wrong with it.
LinearInTime<Vec<3>> displacements_of(const std::string& path, int dim) {
  LinearInTime<Vec<3>> f;
  const NumberTable table = read_csv(path);
  if (table.rows.empty()) throw std::runtime_error(fmt::format("{} holds no rows", path));
  std::vector<std::string_view> known{"time"};
  known.insert(known.end(), axis_names, axis_names + dim);
  for (std::string_view name : known)
    if (table.column(std::string(name)) < 0)
      throw std::runtime_error(fmt::format("{} has no column `{}`; its first line must name the columns {}", path, name,
                                           fmt::join(known, ",")));
  if (table.names.size() != known.size())
    throw std::runtime_error(fmt::format("{} must have the columns {} and no others", path, fmt::join(known, ",")));
  for (std::size_t i = 0; i < table.rows.size(); ++i) {
    Vec<3> d{};
    for (double value : table.rows[i])
      if (!std::isfinite(value))
        throw std::runtime_error(fmt::format("{}:{}: a value is missing or not finite", path, table.lines[i]));
    for (int a = 0; a < dim; ++a) d[a] = table.rows[i][std::size_t(table.column(axis_names[a]))];
    f.times.push_back(table.rows[i][std::size_t(table.column("time"))]);
    f.values.push_back(d);
  }
  return f;
}

LinearInTime<Vec<3>> read_displacements(Section& s, int dim, const std::string& folder) {
  const std::string file = s.text(file_of_motion);
  LinearInTime<Vec<3>> f;
  try {
    f = displacements_of((std::filesystem::path(folder) / file).string(), dim);
    expect_instants(s, "file", "file", f);
  } catch (const std::runtime_error& e) {
    s.complain("file", e.what());
  }
  return f;
}

/// The turn of a solid about its axis.
void read_rotation(Section& s, int dim, PrescribedMotion& motion) {
  motion.centre = vector_of(s.numbers(centre_of_turn, dim));
  if (dim == 3) motion.axis = vector_of(s.numbers(axis_of_turn));
  s.expect_one_of();
  if (s.has("rate"))
    motion.angle = read_constant_rate(s, s.number(rate_of_turn));
  else
    expect_absent(s, {"from", "until"}, "rate");
  if (s.has("angles")) {
    motion.angle.times = s.numbers(times_of_angles);
    motion.angle.values = s.numbers(angles);
    expect_instants(s, "angles", "times", motion.angle);
  } else {
    expect_absent(s, {"times"}, "angles");
  }
  s.close();
}

/// Complains unless there is one displacement, or a rotation and at most one.
void expect_displacement(Section& s, bool turns) {
  const std::vector<std::string_view> ways = {"velocity", "displacements", "file"};
  const auto given = std::count_if(ways.begin(), ways.end(), [&](auto key) { return s.has(key); });
  if (given > 1 || (given == 0 && !turns))
    s.complain(fmt::format("must have exactly one of {}, or `rotation`{}", any_of(ways, "and"), turns ? " alone" : ""));
}

}  // namespace

const Declaration& motion_declaration() {
  static const Declaration d(
      "a motion", {optional(rotation), optional(velocity_of_solid), optional(start_of_motion), optional(end_of_motion),
                   depends(times), optional(displacements), optional(file_of_motion)});
  return d;
}

PrescribedMotion read_motion(Section& s, int dim, const std::string& folder) {
  PrescribedMotion motion;
  const bool turns = s.has("rotation");
  if (turns) {
    Section r = s.section(rotation);
    read_rotation(r, dim, motion);
  }
  expect_displacement(s, turns);
  if (s.has("velocity"))
    motion.displacement = read_constant_rate(s, vector_of(s.numbers(velocity_of_solid, dim)));
  else
    expect_absent(s, {"from", "until"}, "velocity");
  if (s.has("displacements")) {
    LinearInTime<Vec<3>>& f = motion.displacement;
    f.times = s.numbers(times);
    f.values.clear();
    for (const auto& d : s.points(displacements, dim)) f.values.push_back(vector_of(d));
    expect_instants(s, "displacements", "times", f);
  } else {
    expect_absent(s, {"times"}, "displacements");
  }
  if (s.has("file")) motion.displacement = read_displacements(s, dim, folder);
  s.close();
  return motion;
}

}  // namespace talus
