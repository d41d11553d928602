#include <fmt/format.h>

#include "talus/case/defaults.hpp"
#include "talus/case/keys.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr std::string_view example = "write { kind = \"friction\", friction = 0.38 }";

/// Shows the friction of a `rough` surface, which `resolve` takes from the materials.
void note_friction(Section& s, std::string_view key, const Case& case_) {
  s.note(fmt::format("{}.friction", key), fmt::format("{:.4g}", rough_friction(case_)),
         "critical friction of the material");
}

Wall read_word(Section& s, const SurfaceKey& surface, const Case& case_) {
  const Option& option = surface.option;
  const WallKind kind = surface.kinds[std::size_t(s.choice(option))];
  if (kind == WallKind::friction) s.complain(option.key, fmt::format("lacks its coefficient; {}", example));
  if (kind == WallKind::rough) note_friction(s, option.key, case_);
  return {kind, 0, kind != WallKind::friction && surface.separates(kind)};
}

}  // namespace

Wall read_surface(Section& s, const SurfaceKey& surface, const Case& case_) {
  const Option& option = surface.option;
  if (!s.is_table(option.key)) return read_word(s, surface, case_);
  Section t = s.section(option.key, option.meaning);
  Wall wall(surface.kinds[std::size_t(t.required_choice({"kind", option.meaning, option.choices}))]);
  if (wall.kind == WallKind::friction)
    wall.friction = t.number(keys::friction);
  else if (t.has("friction"))
    t.complain("friction", fmt::format("goes with kind `friction` only; {}", example));
  if (wall.kind == WallKind::rough) note_friction(t, "kind", case_);
  if (wall.kind == WallKind::friction || wall.kind == WallKind::rough || wall.kind == WallKind::slip)
    wall.separates = t.flag("separates", surface.separates(wall.kind), "material may lift off; otherwise it is held");
  else if (t.has("separates"))
    t.complain("separates", "goes with kinds `slip` and `friction` only");
  t.close("a wall");
  return wall;
}

}  // namespace talus
