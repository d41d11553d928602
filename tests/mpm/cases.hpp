#pragma once
/// Small runs that several tests begin with.

#include <cmath>

#include "law/parameter_sets.hpp"
#include "talus/mpm/simulation.hpp"

namespace talus {

namespace cases {
inline constexpr double g = 9.81;  ///< [m/s2]
}

/// A block of a material in plane strain or 3D, cells of 1/10 of its height, in the middle of an open domain.
inline Case block(int dim, const AnyLaw& law, double density) {
  Case what;
  what.dim = dim;
  what.domain = dim == 2 ? Box{{0, 0, 0}, {4, 3, 0}} : Box{{0, 0, 0}, {4, 4, 3}};
  what.cell = 0.1;
  for (int a = 0; a < dim; ++a)
    what.n_cells[a] = int(std::lround((what.domain.max[a] - what.domain.min[a]) / what.cell));
  what.gravity[dim - 1] = -cases::g;
  what.materials = {{"stuff", law, density}};
  BodySpec body;
  body.name = "block";
  body.region = dim == 2 ? Box{{1.5, 1.5, 0}, {2, 2.5, 0}} : Box{{1.5, 1.5, 1.5}, {2, 2, 2.5}};
  body.spacing = 0.05;
  what.bodies = {body};
  what.numerics.tau = 0.01;
  what.numerics.cfl = 0.65;  // of quadratic shape functions, whatever the shape
  what.end = 1;
  return what;
}

inline AnyLaw rubber(double E = 1e6, double nu = 0.3) { return LinearElastic{E, nu}; }

/// A sand column at rest between smooth walls on a floor, from x = 0 to 0.4.
inline Case column_at_rest(int dim, WallKind floor) {
  Case what = block(dim, case_1(), 0);
  const Granular law = case_1();
  what.materials = {{"sand", law, 0}};
  what.domain = dim == 2 ? Box{{0, 0, 0}, {0.4, 0.6, 0}} : Box{{0, 0, 0}, {0.4, 0.2, 0.6}};
  what.cell = 0.05;
  for (int a = 0; a < dim; ++a)
    what.n_cells[a] = int(std::lround((what.domain.max[a] - what.domain.min[a]) / what.cell));
  what.walls = {WallKind::slip, WallKind::slip, WallKind::slip, WallKind::slip, WallKind::open, WallKind::open};
  what.walls[2 * dim - 2] = floor;
  what.walls[2 * dim - 1] = WallKind::open;
  what.bodies[0].region = dim == 2 ? Box{{0, 0, 0}, {0.4, 0.5, 0}} : Box{{0, 0, 0}, {0.4, 0.2, 0.5}};
  what.bodies[0].spacing = 0.0125;
  what.bodies[0].void_ratio = 0.85;
  what.bodies[0].initial_stress = InitialStress::k0;
  what.numerics.tau = 0.08 * std::sqrt(0.5 / cases::g);
  return what;
}

inline void run_until(Simulation& s, double end) {
  while (s.ledger().time < end) s.step();
}

inline double value(const Observation& seen, const char* field, int particle, int component = 0) {
  const Field& f = *seen.find(field);
  return f.values[std::size_t(particle) * f.components + component];
}

}  // namespace talus
