#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "talus/input/sections.hpp"

namespace talus {

namespace {

/// The number of the body that a load names; -1 if there is none of this name.
int read_body_of(Section& s, const Case& case_) {
  const std::string name = s.text("body", "name of the body that it acts on");
  std::vector<std::string_view> names;
  for (const BodySpec& b : case_.bodies) names.push_back(b.name);
  const auto found = std::find(names.begin(), names.end(), name);
  if (found != names.end()) return int(found - names.begin());
  if (!name.empty()) s.complain("body", fmt::format("is not among the bodies; there is {}", fmt::join(names, ", ")));
  return -1;
}

Vec<3> read_traction(Section& s, int dim, int side) {
  expect_one_of(s, {"traction", "pressure"});
  Vec<3> traction{};
  if (s.has("traction"))
    traction = vector_of(s.numbers({"traction", "Pa", {}, "force per area on the body, along each axis"}, dim));
  if (s.has("pressure"))
    traction = traction_of_pressure(side, s.number({"pressure", "Pa", {}, "force per area, straight into the body"}));
  return traction;
}

/// The part of a side; none if the input is not right, so that nothing is held against it.
std::optional<Box> read_within(Section& s, int dim) {
  Section w = s.section("within", "the part of the side that it acts on; without it, all");
  const Box within{vector_of(w.numbers({"min", "m", {}, "lower corner"}, dim)),
                   vector_of(w.numbers({"max", "m", {}, "upper corner"}, dim))};
  const bool is_right = w.is_right();
  w.close("a part of space");
  return is_right ? std::optional(within) : std::nullopt;
}

}  // namespace

void read_loads(Section& root, Case& case_) {
  if (!root.has("load")) return;
  for (auto& [name, s] : root.named_sections("load", "stresses on the sides of bodies")) {
    SurfaceLoad load;
    load.name = name;
    load.body = read_body_of(s, case_);
    load.side =
        s.required_choice({"side", "side of the body", std::span(side_choices).first(2 * std::size_t(case_.dim))});
    load.traction = read_traction(s, case_.dim, load.side);
    if (s.has("times") || s.has("factors")) {
      load.factor.times = s.numbers({"times", "s", Range::not_negative(), "instants at which factors are given"}, 0);
      load.factor.values = s.numbers({"factors", "1", {}, "what the load is multiplied by then; linear between"}, 0);
      expect_instants(s, "factors", "times", load.factor);
    }
    if (s.has("within")) load.within = read_within(s, case_.dim);
    s.close("a load");
    case_.loads.push_back(std::move(load));
  }
}

}  // namespace talus
