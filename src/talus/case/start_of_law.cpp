#include "talus/case/start_of_law.hpp"

#include <fmt/format.h>

#include <cmath>

#include "talus/base/units.hpp"
#include "talus/case/material.hpp"

namespace talus {

std::string fault_of_start(const AnyLaw& law, const InitialState& initial) {
  for (int i = 0; i < 6; ++i)
    if (!std::isfinite(initial.stress[i]) || !std::isfinite(initial.strain_rate[i]) ||
        !std::isfinite(initial.collisional_stress[i]))
      return "a stress or strain rate at the start is not finite";
  if (const std::optional<Range> range = void_ratios_of(law)) {
    if (!range->contains(initial.void_ratio))
      return fmt::format("void_ratio = {:g} is out of range; it must be {}", initial.void_ratio, in_words(*range, "1"));
    if (const std::string why = fault_of_void_ratio(law, initial.void_ratio); !why.empty()) return "void_ratio " + why;
  }
  if (initial.kappa && !(*initial.kappa >= 0)) return "kappa must be at least 0";
  if (!(initial.background_pressure >= 0)) return "background_pressure must be at least 0";
  return "";
}

}  // namespace talus
