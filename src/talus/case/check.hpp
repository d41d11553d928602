#pragma once
/// What is wrong with a case.

#include "talus/case/case.hpp"
#include "talus/case/mistake.hpp"

namespace talus {

/// Numbers out of range, things that name nothing, shapes that are none: what a reader refuses while it reads, for cases
/// that were made in C++.
std::vector<Mistake> check_values(const Case& case_);

/// What the values of a case say together, after `resolve` has filled it in; `rough` surfaces before that. Values that a
/// reader could not read are absent or zero, and nothing is held against them; a domain that is not known is NaN.
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

/// The section that a solid stands in.
inline SectionPath section_of(const Solid& solid) {
  if (std::holds_alternative<Ground>(solid.shape)) return {"terrain"};
  return {"solid", solid.name};
}

/// "x_min", of a side of the domain or of a body.
inline std::string name_of_side(int side) { return std::string(side_choices[side].word); }

}  // namespace talus
