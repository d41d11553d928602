#pragma once
/// Map of the surface in 3D: thickness and speed of the material on each patch of ground.

#include <vector>

#include "talus/mpm/simulation.hpp"

namespace talus {

/// A patch of ground as large as a cell, and the material on it.
struct SurfacePatch {
  double x = 0, y = 0;   ///< middle of the patch [m]
  double thickness = 0;  ///< volume over area, measured vertically [m]
  double speed = 0;      ///< mean magnitude of velocity, weighted with mass [m/s]
};

/// Patches that hold material, row by row from low y, from low x in each row. A particle is a cube of its present volume and
/// is divided among the patches below it; the part beyond a side of the domain counts inside. The thickness is smoothed
/// between neighbours that hold material by (1, 2, 1)/4 along x, then along y: particles are divided unevenly among
/// patches, so the thickness alternates from one to the next. The volume is conserved, and a flat surface stays flat.
/// Particles without a finite position do not count. `case_` is three-dimensional.
std::vector<SurfacePatch> surface_map(const Case& case_, const FlowPoints& particles);

}  // namespace talus
