#pragma once
/// The stepper of each dimension and shape function; every shape is compiled in a file of its own.

#include <memory>
#include <vector>

#include "talus/mpm/data/body.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus {

/// Makes a stepper of bodies at rest, with a grid and rigid solids; `shapes`: one for each body.
template <int Dim, class Shape>
std::unique_ptr<Simulation> make_stepper(const Domain<Dim>& domain, std::vector<Body<Dim>> bodies,
                                         std::vector<Shape> shapes, const Vec<Dim>& gravity, const Numerics& numerics,
                                         Backend& backend, std::vector<Solid> solids = {});

}  // namespace talus
