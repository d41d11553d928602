#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr Text body_of_load{"body", "name of the body that it acts on"};
/// In two dimensions a body has the first four sides.
constexpr Option side_of_body(int dim) {
  return {"side", "side of the body", std::span(side_choices).first(2 * std::size_t(dim))};
}
constexpr Numbers traction{{"traction", "Pa", {}, "force per area on the body, along each axis"}, one_per_axis};
constexpr Parameter pressure_on_side{"pressure", "Pa", {}, "pressure, normal to the side and into the body"};
constexpr Numbers times_of_factors{{"times", "s", Range::not_negative(), "instants at which factors are given"}},
    factors{{"factors", "1", {}, "factors on the load at these instants; linear in between"}},
    lower_within{{"min", "m", {}, "lower corner"}, one_per_axis},
    upper_within{{"max", "m", {}, "upper corner"}, one_per_axis};

const Declaration& within_declaration() {
  static const Declaration d("a part of space", {required(lower_within), required(upper_within)});
  return d;
}
constexpr Table within_table{"within", "part of the side on which the load acts; without it, all of the side",
                             within_declaration};

/// The number of the body that a load names; -1 if there is none of this name.
int read_body_of(Section& s, const Case& case_) {
  const std::string name = s.text(body_of_load);
  std::vector<std::string_view> names;
  for (const BodySpec& b : case_.bodies) names.push_back(b.name);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return int(found - names.begin());
  if (!name.empty()) s.complain("body", fmt::format("is not among the bodies; there is {}", fmt::join(names, ", ")));
  return -1;
}

Vec<3> read_traction(Section& s, int dim, int side) {
  s.expect_one_of();
  Vec<3> given{};
  if (s.has("traction")) given = vector_of(s.numbers(traction, dim));
  if (s.has("pressure")) given = traction_of_pressure(side, s.number(pressure_on_side));
  return given;
}

/// The part of a side; none if the input is not right, so that nothing is held against it.
std::optional<Box> read_within(Section& s, int dim) {
  Section w = s.section(within_table);
  const Box within{vector_of(w.numbers(lower_within, dim)), vector_of(w.numbers(upper_within, dim))};
  const bool is_right = w.is_right();
  w.close();
  return is_right ? std::optional(within) : std::nullopt;
}

}  // namespace

const Declaration& load_declaration() {
  static const Declaration d(
      "a load",
      {required(body_of_load), required(side_of_body(3)), optional(traction), optional(pressure_on_side),
       depends(times_of_factors), depends(factors), optional(within_table)},
      {"traction", "pressure"});
  return d;
}

void read_loads(Section& root, Case& case_) {
  if (!root.has("load")) return;
  for (auto& [name, s] : root.named_sections(keys::loads)) {
    SurfaceLoad load;
    load.name = name;
    load.body = read_body_of(s, case_);
    load.side = s.required_choice(side_of_body(case_.dim));
    load.traction = read_traction(s, case_.dim, load.side);
    if (s.has("times") || s.has("factors")) {
      load.factor.times = s.numbers(times_of_factors);
      load.factor.values = s.numbers(factors);
      expect_instants(s, "factors", "times", load.factor);
    }
    if (s.has("within")) load.within = read_within(s, case_.dim);
    s.close();
    case_.loads.push_back(std::move(load));
  }
}

}  // namespace talus
