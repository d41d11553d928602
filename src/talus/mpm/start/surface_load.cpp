#include "talus/mpm/start/surface_load.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <map>

namespace talus {

std::vector<double> loaded_areas(const Case& case_, const SurfaceLoad& load, const Filling& particles) {
  const BodySpec& body = case_.bodies[load.body];
  const int axis = load.side / 2;
  const double outwards = load.side % 2 == 0 ? -1 : 1, half = 0.5 * body.spacing;
  const Box box = bounding_box(body.region, case_.dim), kept = kept_by_symmetry(case_);
  // The particles share the volume of the body: the length of each along the axis may differ from the spacing.
  const double depth = (box.max[axis] - box.min[axis]) / lattice_planes(body, box, axis);

  std::map<std::array<int, 3>, std::size_t> outermost;  // outermost particle of every row
  for (std::size_t i = 0; i < particles.points.size(); ++i) {
    const Vec<3>& x = particles.points[i];
    std::array<int, 3> row{};
    for (int a = 0; a < case_.dim; ++a)
      if (a != axis) row[std::size_t(a)] = int(std::floor((x[a] - box.min[a]) / body.spacing));
    const auto [found, is_new] = outermost.try_emplace(row, i);
    if (!is_new && outwards * (x[axis] - particles.points[found->second][axis]) > 0) found->second = i;
  }

  std::vector<double> areas(particles.points.size(), 0.0);
  for (const auto& [row, i] : outermost) {
    const Vec<3>& x = particles.points[i];
    const double surface = x[axis] + outwards * half;
    double area = particles.volumes[i] / depth;
    if (case_.axisymmetric && axis == 0) area *= surface / x[0];  // volumes are per radian, at the particle's radius
    if (load.within)
      for (int a = 0; a < case_.dim; ++a) {
        const double low = load.within->min[a], high = load.within->max[a];
        if (a == axis) {
          area *= surface >= low - half && surface <= high + half;
          continue;
        }
        // Area of the row, or of its part in front of planes of symmetry; axisymmetric of its ring.
        const double from = std::max(kept.min[a], box.min[a] + row[std::size_t(a)] * body.spacing),
                     to = std::min(kept.max[a], box.min[a] + (row[std::size_t(a)] + 1) * body.spacing);
        const auto size = [&](double x0, double x1) {
          return x1 <= x0 ? 0 : case_.axisymmetric && a == 0 ? x1 * x1 - x0 * x0 : x1 - x0;
        };
        area *= size(std::max(from, low), std::min(to, high)) / size(from, to);
      }
    areas[i] = area;
  }
  return areas;
}

}  // namespace talus
