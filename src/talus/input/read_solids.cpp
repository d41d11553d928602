#include "talus/base/text.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr Flag hollow{"hollow", "the solid is the space outside its shape: a drum, a bowl, a pipe"};
constexpr Table motion{"motion", "motion of the solid; without it, the solid is at rest", motion_declaration};

}  // namespace

const Declaration& solid_declaration() {
  static const Declaration d("a solid",
                             {optional(keys::half_space), optional(keys::box), optional(keys::sphere),
                              optional(keys::cylinder), optional(keys::polygon), optional(keys::mesh), optional(hollow),
                              required(key_of_contact().option), required(key_of_contact().table), optional(motion)},
                             {"half_space", "box", "sphere", "cylinder", "polygon", "mesh"});
  return d;
}

void read_solids(Section& root, Case& case_, const std::string& folder) {
  if (!root.has("solid")) return;
  for (auto& [name, s] : root.named_sections(keys::solids)) {
    Solid solid{name, read_solid_shape(s, case_.dim, folder), {}};
    solid.hollow = s.flag(hollow, solid.hollow);
    solid.contact = read_surface(s, key_of_contact(), case_);
    if (!s.has("contact")) s.complain("`contact` is missing: " + any_of({"slip", "no_slip", "friction", "rough"}));
    if (s.has("motion")) {
      Section m = s.section(motion);
      solid.motion = read_motion(m, case_.dim, folder);
    }
    s.close();
    case_.solids.push_back(std::move(solid));
  }
}

}  // namespace talus
