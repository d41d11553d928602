#pragma once
/// Checks of a case.

#include "talus/case/case.hpp"
#include "talus/case/mistake.hpp"

namespace talus {

/// Numbers out of range, names without an object, invalid shapes: checks that a reader makes while it reads, for cases
/// made in C++.
std::vector<Mistake> check_values(const Case& case_);

/// Contradictions between values of a resolved case; `rough` surfaces are checked before. Values that a reader could
/// not read are absent or zero and are not checked; an unknown domain is NaN.
void check_rough_surfaces(const Case& case_, std::vector<Mistake>& mistakes);
void check_domain(const Case& case_, std::vector<Mistake>& mistakes);
void check_bodies(const Case& case_, std::vector<Mistake>& mistakes);
void check_loads(const Case& case_, std::vector<Mistake>& mistakes);
void check_solids(const Case& case_, std::vector<Mistake>& mistakes);
void check_numerics(const Case& case_, std::vector<Mistake>& mistakes);
void check_output(const Case& case_, std::vector<Mistake>& mistakes);
void check_gauges(const Case& case_, std::vector<Mistake>& mistakes);  ///< and the thalweg

inline constexpr double most_cells_along_axis = 1e6;
inline constexpr double most_particles = 2e8;
inline constexpr const char* axis_names[] = {"x", "y", "z"};

/// Section of a solid in the input file.
inline SectionPath section_of(const Solid& solid) {
  if (std::holds_alternative<Ground>(solid.shape)) return {"terrain"};
  return {"solid", solid.name};
}

/// Name of a side of the domain or of a body, such as "x_min".
inline std::string name_of_side(int side) { return std::string(side_choices[side].word); }

}  // namespace talus
