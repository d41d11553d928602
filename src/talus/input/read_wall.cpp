#include <fmt/format.h>

#include "talus/case/defaults.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr WallKind wall_kinds[] = {WallKind::open,     WallKind::outflow, WallKind::slip,     WallKind::no_slip,
                                   WallKind::friction, WallKind::rough,   WallKind::symmetry, WallKind::periodic};
constexpr const char *meaning_of_wall = "wall on this side of the domain",
                     *meaning_of_contact = "boundary condition on its surface";
constexpr Flag separates{"separates", "material may separate from the surface"};

/// The table of a surface that may be of some kinds.
Declaration declaration_of(const Option& kind) {
  return {"a wall",
          {required(kind), required(keys::friction).with("kind", {"friction"}),
           optional(separates).with("kind", {"slip", "friction", "rough"})}};
}
const Declaration& ground_contact_declaration() {
  static const Declaration d{
      "the surface of the ground",
      {required(Option{"kind", meaning_of_contact, ground_choices}),
       required(keys::friction).with("kind", {"friction", "voellmy"}), required(keys::xi).with("kind", {"voellmy"}),
       optional(separates).with("kind", {"slip", "friction", "rough", "voellmy"})}};
  return d;
}
const Declaration& wall_declaration() {
  static const Declaration d = declaration_of({"kind", meaning_of_wall, wall_choices});
  return d;
}
const Declaration& contact_declaration() {
  static const Declaration d = declaration_of({"kind", meaning_of_contact, contact_choices});
  return d;
}

constexpr std::string_view example = "write { kind = \"friction\", friction = 0.38 }",
                           example_of_voellmy = "write { kind = \"voellmy\", friction = 0.2, xi = \"2000 m/s2\" }";
constexpr WallKind ground_kinds[] = {WallKind::slip, WallKind::no_slip, WallKind::friction, WallKind::rough,
                                     WallKind::friction};
bool is_voellmy(const SurfaceKey& surface, int choice) {
  return surface.option.choices[std::size_t(choice)].word == "voellmy";
}

/// Shows the friction of a `rough` surface, which `resolve` takes from the materials.
void note_friction(Section& s, std::string_view key, const Case& case_) {
  s.note(fmt::format("{}.friction", key), fmt::format("{:.4g}", rough_friction(case_)),
         "critical friction of the material");
}

Wall read_word(Section& s, const SurfaceKey& surface, const Case& case_) {
  const Option& option = surface.option;
  const int choice = s.choice(option);
  const WallKind kind = surface.kinds[std::size_t(choice)];
  if (is_voellmy(surface, choice))
    s.complain(option.key, fmt::format("lacks its coefficients; {}", example_of_voellmy));
  else if (kind == WallKind::friction)
    s.complain(option.key, fmt::format("lacks its coefficient; {}", example));
  if (kind == WallKind::rough) note_friction(s, option.key, case_);
  return {kind, 0, kind != WallKind::friction && surface.separates(kind)};
}

}  // namespace

SurfaceKey key_of_wall(int side) {
  const std::string_view key = side_choices[side].word;
  return {
      {key, meaning_of_wall, wall_choices}, {key, meaning_of_wall, wall_declaration}, wall_kinds, separates_from_wall};
}

SurfaceKey key_of_contact() {
  return {{"contact", meaning_of_contact, contact_choices},
          {"contact", meaning_of_contact, contact_declaration},
          contact_kinds,
          separates_from_solid};
}

SurfaceKey key_of_ground() {
  return {{"contact", meaning_of_contact, ground_choices},
          {"contact", meaning_of_contact, ground_contact_declaration},
          ground_kinds,
          separates_from_solid,
          true};
}

Wall read_surface(Section& s, const SurfaceKey& surface, const Case& case_) {
  const Option& option = surface.option;
  if (!s.is_table(option.key)) return read_word(s, surface, case_);
  Section t = s.section(surface.table);
  const int choice = t.required_choice({"kind", option.meaning, option.choices});
  Wall wall(surface.kinds[std::size_t(choice)]);
  if (wall.kind == WallKind::friction)
    wall.friction = t.number(keys::friction);
  else if (t.has("friction"))
    t.complain("friction", surface.may_be_turbulent
                               ? fmt::format("goes with kinds `friction` and `voellmy` only; {}", example)
                               : fmt::format("goes with kind `friction` only; {}", example));
  if (is_voellmy(surface, choice))
    wall.xi = t.number(keys::xi);
  else if (surface.may_be_turbulent && t.has("xi"))
    t.complain("xi", fmt::format("goes with kind `voellmy` only; {}", example_of_voellmy));
  if (wall.kind == WallKind::rough) note_friction(t, "kind", case_);
  if (wall.kind == WallKind::friction || wall.kind == WallKind::rough || wall.kind == WallKind::slip)
    wall.separates = t.flag(separates, surface.separates(wall.kind));
  else if (t.has("separates"))
    t.complain("separates", "goes with kinds `slip` and `friction` only");
  t.close();
  return wall;
}

}  // namespace talus
