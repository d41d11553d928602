#include "talus/base/text.hpp"
#include "talus/case/defaults.hpp"
#include "talus/input/sections.hpp"

namespace talus {

void read_solids(Section& root, Case& case_, const std::string& folder) {
  if (!root.has("solid")) return;
  for (auto& [name, s] : root.named_sections("solid", "rigid solids inside the domain")) {
    Solid solid{name, read_solid_shape(s, case_.dim), {}};
    solid.hollow = s.flag("hollow", solid.hollow, "the solid is what lies outside its shape: a drum, a bowl, a pipe");
    solid.contact = read_surface(
        s, {{"contact", "what its surface does to material", contact_choices}, contact_kinds, separates_from_solid},
        case_);
    if (!s.has("contact")) s.complain("`contact` is missing: " + any_of({"slip", "no_slip", "friction", "rough"}));
    if (s.has("motion")) {
      Section m = s.section("motion", "how the solid moves; without it, it rests");
      solid.motion = read_motion(m, case_.dim, folder);
    }
    s.close("a solid");
    case_.solids.push_back(std::move(solid));
  }
}

}  // namespace talus
