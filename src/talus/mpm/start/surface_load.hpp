#pragma once
/// Loads on sides of bodies.

#include <string>
#include <vector>

#include "talus/mpm/start/filling.hpp"

namespace talus {

/// The area [m2] of the loaded side that each particle of a body represents; in plane strain per metre of thickness,
/// axisymmetric per radian. The body has its particles in the middle of cells. The side consists of the outermost
/// particle of every row of the lattice across it, so areas are projected along the axis of the side, also if it is
/// curved. All are zero if `within` excludes the whole side.
std::vector<double> loaded_areas(const Case& case_, const SurfaceLoad& load, const Filling& particles);

}  // namespace talus
