#include "talus/output/surface_map.hpp"

#include <algorithm>
#include <cmath>

#include "talus/output/patches.hpp"

namespace talus {

namespace {

/// Motion of the material on a patch.
struct PatchMotion {
  double mass = 0;      ///< [kg]
  double momentum = 0;  ///< sum of mass times speed, without direction [kg m/s]
};

/// Thickness on a row of patches, where neighbours that hold material (thickness > 0) exchange a quarter of their difference.
/// `stride`: distance of neighbours in `thickness`; the row has n patches from `first` on.
void smooth_row(std::vector<double>& thickness, std::size_t first, std::size_t stride, int n) {
  std::vector<double> old(static_cast<std::size_t>(n));
  for (std::size_t k = 0; k < old.size(); ++k) old[k] = thickness[first + k * stride];
  for (std::size_t k = 0; k + 1 < old.size(); ++k) {
    if (old[k] == 0 || old[k + 1] == 0) continue;
    const double moved = 0.25 * (old[k + 1] - old[k]);
    thickness[first + k * stride] += moved;
    thickness[first + (k + 1) * stride] -= moved;
  }
}

}  // namespace

std::vector<SurfacePatch> surface_map(const Case& case_, const FlowPoints& particles) {
  const Box& domain = case_.domain;
  const int nx = case_.n_cells[0], ny = case_.n_cells[1];
  const double cell = case_.cell;
  const Patches grid({domain.min[0], domain.min[1]}, {nx, ny}, cell);
  const auto number = [&](int i, int j) { return std::size_t(j) * std::size_t(nx) + std::size_t(i); };
  std::vector<double> thickness(std::size_t(nx) * std::size_t(ny));
  std::vector<PatchMotion> motion(thickness.size());
  for (std::size_t p = 0; p < particles.places.size(); ++p) {
    const Vec<3>& x = particles.places[p];
    const double volume = particles.volumes[p], mass = particles.masses[p], half = std::cbrt(volume) / 2;
    const double speed = length(particles.velocities[p]);
    const auto inside = [&](int a) {
      return std::min(x[a] + half, domain.max[a]) - std::max(x[a] - half, domain.min[a]);
    };
    grid.divide(0, x[0] - half, x[0] + half, [&](int i, double low, double high) {
      grid.divide(1, x[1] - half, x[1] + half, [&](int j, double near, double far) {
        const double share = (high - low) / inside(0) * (far - near) / inside(1);
        thickness[number(i, j)] += share * volume / (cell * cell);
        motion[number(i, j)].mass += share * mass;
        motion[number(i, j)].momentum += share * mass * speed;
      });
    });
  }
  for (int j = 0; j < ny; ++j) smooth_row(thickness, number(0, j), 1, nx);
  for (int i = 0; i < nx; ++i) smooth_row(thickness, number(i, 0), std::size_t(nx), ny);

  std::vector<SurfacePatch> patches;
  for (int j = 0; j < ny; ++j)
    for (int i = 0; i < nx; ++i)
      if (const PatchMotion& m = motion[number(i, j)]; m.mass > 0)
        patches.push_back({domain.min[0] + (i + 0.5) * cell, domain.min[1] + (j + 0.5) * cell, thickness[number(i, j)],
                           m.momentum / m.mass});
  return patches;
}

}  // namespace talus
