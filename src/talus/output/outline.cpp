#include "talus/output/outline.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <optional>
#include <unordered_set>

namespace talus {

namespace {

/// How near the axis heights there are taken, in cells. A layer that has spread to q times its radius has no particle
/// within q/2 of their spacing of the axis: in one cell the surface would seem to be where the last of them stay.
constexpr double near_axis_cells = 2;

/// One particle along some coordinate: where its centre is, and how far it reaches beyond.
struct Reach {
  double centre, half;
};

/// The range [low, high] of what is connected to the median: reached from it through strips of a given width that all
/// hold a part of a particle, as those of a deposit do. Particles of a broken run that are nowhere do not count.
std::pair<double, double> connected_range(std::vector<Reach> particles, double width) {
  std::erase_if(particles, [&](const Reach& p) { return !(std::abs(p.centre) < 1e9 * width); });
  if (particles.empty()) return {0, 0};
  const auto strip_of = [&](double x) { return std::floor(x / width); };
  const auto median = particles.begin() + particles.size() / 2;
  std::nth_element(particles.begin(), median, particles.end(),
                   [](const Reach& a, const Reach& b) { return a.centre < b.centre; });
  std::unordered_set<double> strips;
  const double rounding = 1e-12 * width;  // what ends at a strip's edge is not also beyond it
  for (const Reach& p : particles) {
    const double half = std::min(p.half, width) - rounding;  // grains that fly apart take up any volume
    for (double strip = strip_of(p.centre - half); strip <= strip_of(p.centre + half); ++strip) strips.insert(strip);
  }

  double low = strip_of(median->centre), high = low;
  while (strips.contains(low - 1)) --low;
  while (strips.contains(high + 1)) ++high;
  double least = median->centre, most = least;
  for (const Reach& p : particles) {
    if (strip_of(p.centre) < low || strip_of(p.centre) > high) continue;
    least = std::min(least, p.centre - p.half);
    most = std::max(most, p.centre + p.half);
  }
  return {least, most};
}

constexpr double infinite = std::numeric_limits<double>::infinity();

/// A patch of ground and what lies on it.
struct Patch {
  double volume = 0, area = 0;
  /// How far the material reaches along each axis, towards the low and the high side; outwards positive.
  double reach[2][2] = {{-infinite, -infinite}, {-infinite, -infinite}};

  double thickness() const { return volume / area; }
  void add(double more, int axis, double low, double high) {
    volume += more;
    stretch(axis, low, high);
  }
  void stretch(int axis, double low, double high) {
    reach[axis][0] = std::max(reach[axis][0], -low);
    reach[axis][1] = std::max(reach[axis][1], high);
  }
};

/// n[0] x n[1] patches as wide as a cell.
class Patches {
 public:
  Patches(std::array<double, 2> origin, std::array<int, 2> n, double width)
      : origin_(origin), n_(n), width_(width), patches_(std::size_t(n[0]) * n[1]) {}

  Patch& at(int i, int j = 0) { return patches_[std::size_t(j) * n_[0] + i]; }
  const Patch& at(int i, int j = 0) const { return patches_[std::size_t(j) * n_[0] + i]; }
  double middle(int i) const { return origin_[0] + (i + 0.5) * width_; }
  int n() const { return n_[0]; }

  /// Calls with every patch along an axis that [low, high] meets, and with the part in it.
  template <class Take>
  void divide(int axis, double low, double high, Take take) const {
    low = std::max(low, origin_[axis]);
    high = std::min(high, origin_[axis] + n_[axis] * width_);
    if (!(low < high)) return;               // beyond the domain, or nowhere
    const double rounding = 1e-12 * width_;  // so that what ends at a patch's edge is not also beyond it
    for (int i = std::clamp(int((low - origin_[axis]) / width_) - 1, 0, n_[axis] - 1); i < n_[axis]; ++i) {
      const double begin = origin_[axis] + i * width_, end = begin + width_;
      if (begin > high - rounding) break;
      if (end > low + rounding) take(i, std::max(low, begin), std::min(high, end));
    }
  }

  /// How thick the material is on average over a patch and those around it that hold some.
  double mean_thickness(std::size_t k) const {
    const int i0 = int(k) % n_[0], j0 = int(k) / n_[0];
    double volume = 0, area = 0;
    for (int j = std::max(j0 - 1, 0); j <= std::min(j0 + 1, n_[1] - 1); ++j)
      for (int i = std::max(i0 - 1, 0); i <= std::min(i0 + 1, n_[0] - 1); ++i) {
        if (at(i, j).volume == 0) continue;
        volume += at(i, j).volume;
        area += at(i, j).area;
      }
    return area > 0 ? volume / area : 0;
  }

  /// Patches of the deposit: that hold material, on average at least `level` thick, and are connected by their sides; of
  /// several such sets the one that holds most.
  std::vector<bool> deposit(double level) const {
    std::vector<int> set(patches_.size(), 0);  // that a patch belongs to, from 1
    int n_sets = 0, best = 0;
    double most = 0;
    std::vector<std::size_t> open;
    const auto enter = [&](std::size_t k) {
      // A layer just as thick as the level counts, however its volume is rounded.
      if (set[k] != 0 || patches_[k].volume == 0 || !(mean_thickness(k) >= level * (1 - 1e-9))) return;
      set[k] = n_sets;
      open.push_back(k);
    };
    for (std::size_t start = 0; start < patches_.size(); ++start) {
      ++n_sets;
      double volume = 0;
      for (enter(start); !open.empty();) {
        const std::size_t k = open.back();
        open.pop_back();
        volume += patches_[k].volume;
        for (int axis = 0; axis < 2; ++axis)
          for (int side = 0; side < 2; ++side)
            if (const auto next = neighbour(k, axis, side)) enter(*next);
      }
      if (volume > most) {
        most = volume;
        best = n_sets;
      }
    }
    std::vector<bool> members(patches_.size());
    for (std::size_t k = 0; k < set.size(); ++k) members[k] = best > 0 && set[k] == best;
    return members;
  }

  /// Where the deposit ends along an axis, at its low (0) or high (1) side; NaN if there is none.
  double front(const std::vector<bool>& deposit, double level, int axis, int side) const {
    const double sign = side == 0 ? -1 : 1;
    double farthest = -infinite;  // outwards positive
    for (std::size_t k = 0; k < patches_.size(); ++k) {
      const auto next = neighbour(k, axis, side);
      if (!deposit[k] || (next && deposit[*next])) continue;
      const int i = axis == 0 ? int(k % n_[0]) : int(k / n_[0]);
      double edge = sign * (origin_[axis] + (i + 0.5) * width_), reach = patches_[k].reach[axis][side];
      if (next && patches_[*next].volume > 0) {
        edge += width_ * (mean_thickness(k) - level) / (mean_thickness(k) - mean_thickness(*next));
        reach = std::max(reach, patches_[*next].reach[axis][side]);
      } else {  // nothing beyond
        edge += width_ / 2;
      }
      farthest = std::max(farthest, std::min(edge, reach));
    }
    return std::isinf(farthest) ? std::numeric_limits<double>::quiet_NaN() : sign * farthest + 0.0;  // no -0
  }

 private:
  std::optional<std::size_t> neighbour(std::size_t k, int axis, int side) const {
    const std::size_t stride = axis == 0 ? 1 : n_[0];
    const int i = axis == 0 ? int(k % n_[0]) : int(k / n_[0]);
    if (i == (side == 0 ? 0 : n_[axis] - 1)) return std::nullopt;
    return side == 0 ? k - stride : k + stride;
  }

  std::array<double, 2> origin_;
  std::array<int, 2> n_;
  double width_;
  std::vector<Patch> patches_;
};

/// From the first to the last patch that holds material, and an empty one beyond each, so that the surface comes down.
/// Neighbours that hold material exchange a quarter of what one is thicker than the other, (1, 2, 1)/4: particles in rows
/// fall into patches unevenly, and what alternates from one to the next is that. Volume stays, and flat stays flat.
Surface surface_of(const Patches& patches) {
  const auto taken_by = [&](int i, int j) {
    if (j < 0 || j >= patches.n() || patches.at(j).volume == 0) return 0.0;
    const Patch &own = patches.at(i), &other = patches.at(j);
    return 0.25 * (other.thickness() - own.thickness()) * 0.5 * (own.area + other.area) / own.area;
  };
  Surface surface;
  int first = 0, end = patches.n();
  while (first < end && patches.at(first).volume == 0) ++first;
  while (end > first && patches.at(end - 1).volume == 0) --end;
  for (int i = std::max(first - 1, 0); i < std::min(end + 1, patches.n()); ++i) {
    const double own = patches.at(i).thickness();
    surface.places.push_back(patches.middle(i));
    surface.thickness.push_back(own == 0 ? 0 : own + taken_by(i, i - 1) + taken_by(i, i + 1));
  }
  return surface;
}

}  // namespace

OutlineFinder::OutlineFinder(const Case& what, const ParticlePlaces& start)
    : dim_(what.dim),
      cell_(what.cell),
      floor_(what.domain.min[what.dim - 1]),
      level_(what.output.front_thickness.value_or(0)),
      axisymmetric_(what.axisymmetric),
      domain_(what.domain),
      n_cells_(what.n_cells),
      axis_{},
      angle_(what.axisymmetric ? 1 : 2 * std::numbers::pi) {
  for (const Vec<3>& x : start.places) axis_ = axis_ + (1.0 / double(start.places.size())) * x;
  if (axisymmetric_) axis_ = {};
  for (double size : start.sizes) half_sizes_.push_back(size / 2);
  for (int a = 0; a < what.dim - 1; ++a) {  // the axis of what a plane of symmetry cuts lies in it
    const bool low = what.walls[2 * a].kind == WallKind::symmetry,
               high = what.walls[2 * a + 1].kind == WallKind::symmetry;
    if (low) axis_[a] = what.domain.min[a];
    if (high) axis_[a] = what.domain.max[a];
    if (low || high) angle_ /= 2;
  }
}

double OutlineFinder::radius_of(const Vec<3>& place) const {
  double r2 = 0;
  for (int a = 0; a < dim_ - 1; ++a) r2 += (place[a] - axis_[a]) * (place[a] - axis_[a]);
  return std::sqrt(r2);
}

void OutlineFinder::find_deposit(const ParticlePlaces& particles, Outline& outline) const {
  if (!axisymmetric_) {
    const bool plane = dim_ == 2;
    Patches ground({domain_.min[0], plane ? 0 : domain_.min[1]}, {n_cells_[0], plane ? 1 : n_cells_[1]}, cell_);
    for (int i = 0; i < ground.n(); ++i)
      for (int j = 0; j < (plane ? 1 : n_cells_[1]); ++j) ground.at(i, j).area = plane ? cell_ : cell_ * cell_;
    for (std::size_t p = 0; p < particles.places.size(); ++p) {
      const Vec<3>& x = particles.places[p];
      const double size = particles.sizes[p], half = size / 2;
      // What a wall or a plane of symmetry cuts off stands on this side of it.
      const auto inside = [&](int a) {
        return std::min(x[a] + half, domain_.max[a]) - std::max(x[a] - half, domain_.min[a]);
      };
      ground.divide(0, x[0] - half, x[0] + half, [&](int i, double low, double high) {
        const double slice = (high - low) / inside(0) * size * size;
        if (plane) {
          ground.at(i).add(slice, 0, low, high);
        } else {
          ground.divide(1, x[1] - half, x[1] + half, [&](int j, double near, double far) {
            ground.at(i, j).add(slice * (far - near) / inside(1) * size, 0, low, high);
            ground.at(i, j).stretch(1, near, far);
          });
        }
      });
    }
    const std::vector<bool> deposit = ground.deposit(level_);
    for (int a = 0; a < dim_ - 1; ++a) {
      outline.front_min[a] = ground.front(deposit, level_, a, 0);
      outline.front_max[a] = ground.front(deposit, level_, a, 1);
    }
    if (plane) {
      outline.surface = surface_of(ground);
      return;
    }
  }
  double farthest = 0;  // of the domain's corners from the axis
  for (int a = 0; a < dim_ - 1; ++a)
    farthest = std::hypot(farthest, std::max(domain_.max[a] - axis_[a], axis_[a] - domain_.min[a]));
  const double nearest = axisymmetric_ ? domain_.min[0] : 0;
  Patches rings({nearest, 0}, {int(std::ceil((farthest - nearest) / cell_ * (1 - 1e-12))), 1}, cell_);
  for (int i = 0; i < rings.n(); ++i) rings.at(i).area = angle_ * cell_ * rings.middle(i);
  for (std::size_t p = 0; p < particles.places.size(); ++p) {
    const double r = radius_of(particles.places[p]), size = particles.sizes[p];
    const double near = std::max(0.0, r - size / 2), far = r + size / 2;
    const double volume = axisymmetric_ ? size * size * r : size * size * size;
    rings.divide(0, near, far, [&](int i, double low, double high) {  // equally thick, so by area
      rings.at(i).add(volume * (high * high - low * low) / (far * far - near * near), 0, low, high);
    });
  }
  const std::vector<bool> deposit = rings.deposit(level_);
  outline.front_radius = rings.front(deposit, level_, 0, 1);
  if (axisymmetric_) {
    outline.front_min[0] = rings.front(deposit, level_, 0, 0);
    outline.front_max[0] = outline.front_radius;
  }
  outline.surface = surface_of(rings);
}

Outline OutlineFinder::find(const ParticlePlaces& particles) const {
  Outline outline;
  const std::vector<Vec<3>>& places = particles.places;
  const int up = dim_ - 1;
  std::vector<Reach> along(places.size());
  const auto range_along = [&](int axis) {
    for (std::size_t i = 0; i < places.size(); ++i) along[i] = {places[i][axis], half_sizes_[i]};
    return connected_range(along, cell_);
  };
  for (int axis = 0; axis < dim_ - 1; ++axis) {
    const auto [low, high] = range_along(axis);
    outline.farthest_min[axis] = low;
    outline.farthest_max[axis] = high;
  }
  outline.height = range_along(up).second - floor_;
  std::vector<Reach> near_axis;
  for (std::size_t i = 0; i < places.size(); ++i) {
    const double r = radius_of(places[i]);
    if (r <= near_axis_cells * cell_) near_axis.push_back({places[i][up], half_sizes_[i]});
    along[i] = {r, half_sizes_[i]};
  }
  outline.height_at_axis = near_axis.empty() ? 0 : connected_range(near_axis, cell_).second - floor_;
  if (dim_ == 3) outline.farthest_radius = connected_range(along, cell_).second;
  if (axisymmetric_) outline.farthest_radius = outline.farthest_max[0];
  find_deposit(particles, outline);
  return outline;
}

}  // namespace talus
