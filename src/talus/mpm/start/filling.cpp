#include "talus/mpm/start/filling.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <random>

namespace talus {

int lattice_planes(const BodySpec& body, const Box& box, int axis) {
  const double offset = body.lattice == Lattice::cells ? 0.5 : 0;
  return int(std::floor((box.max[axis] - box.min[axis]) / body.spacing - offset + 1e-9)) + 1;
}

double lattice_places(const Case& case_, const BodySpec& body) {
  if (const auto* list = std::get_if<PointList>(&body.region)) return double(list->places.size());
  if (const auto* layer = std::get_if<SurfaceLayer>(&body.region)) return double(layer->thickness.values.size());
  const Box box = bounding_box(body.region, case_.dim);
  double n = 1;
  for (int a = 0; a < case_.dim; ++a) n *= std::max(1.0, (box.max[a] - box.min[a]) / body.spacing);
  return n;
}

Filling fill(const Case& case_, const BodySpec& body) {
  const Box kept = kept_by_symmetry(case_);
  const double close = 1e-9 * case_.cell;
  Filling filling;
  double sum = 0;
  const auto add = [&](Vec<3> x, double volume) {
    for (int a = 0; a < case_.dim; ++a) {
      if (x[a] < kept.min[a] - close || x[a] > kept.max[a] + close) return;
      const bool on_plane = x[a] <= kept.min[a] + close || x[a] >= kept.max[a] - close;
      if (on_plane) {
        x[a] = std::clamp(x[a], kept.min[a], kept.max[a]);
        volume *= 0.5;
      }
    }
    filling.points.push_back(x);
    filling.volumes.push_back(volume);
    sum += volume;
  };
  if (const auto* list = std::get_if<PointList>(&body.region)) {
    for (std::size_t i = 0; i < list->places.size(); ++i) add(list->places[i], list->volumes[i]);
    return filling;
  }
  if (const auto* layer = std::get_if<SurfaceLayer>(&body.region)) {
    for_each_point(*layer, [&](const Vec<3>& x, double volume) { add(x, volume); });
    return filling;
  }
  const Box box = bounding_box(body.region, case_.dim);
  const double offset = body.lattice == Lattice::cells ? 0.5 : 0;
  // A point that would leave the body, or cross a plane of symmetry, stays on its place. The engine's numbers are the
  // same everywhere, those of the standard's distributions are not.
  std::mt19937_64 random(std::uint64_t(body.seed));
  const auto scattered = [&](const Vec<3>& place) {
    Vec<3> x = place;
    bool beyond = false;
    for (int a = 0; a < case_.dim; ++a) {
      const double from_minus_1_to_1 = double(random() >> 11) * 0x1p-52 - 1;
      x[a] += body.scatter * body.spacing * from_minus_1_to_1;
      for (const double plane : {kept.min[a], kept.max[a]}) beyond |= (x[a] - plane) * (place[a] - plane) <= 0;
    }
    return beyond || !contains(body.region, x, case_.dim) ? place : x;
  };
  Index<3> n{1, 1, 1};
  for (int a = 0; a < case_.dim; ++a) n[a] = lattice_planes(body, box, a);
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        Vec<3> x{};
        const Index<3> at{i, j, k};
        for (int a = 0; a < case_.dim; ++a) x[a] = box.min[a] + (at[a] + offset) * body.spacing;
        if (!contains(body.region, x, case_.dim)) continue;
        if (body.scatter > 0) x = scattered(x);
        add(x, case_.axisymmetric ? x[0] : 1);
      }
  // The points share the exact volume of the region, so its mass is exact whatever the lattice; around an axis in
  // proportion to their radius.
  bool cut = false;
  for (const Wall& wall : case_.walls) cut |= wall.kind == WallKind::symmetry;
  const double whole = case_.axisymmetric ? volume_per_radian(body.region)
                       : cut              ? volume(body.region, case_.dim, kept)
                                          : volume(body.region, case_.dim);
  for (double& v : filling.volumes) v = whole * v / sum;
  return filling;
}

}  // namespace talus
