#include "talus/output/outline.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <limits>
#include <numbers>

#include "talus/output/patches.hpp"

namespace talus {

namespace {

/// Distance from the axis within which heights at the axis are measured, in cells. A layer that has spread to q times its
/// radius has no particle within q/2 of their spacing of the axis: within one cell the surface would seem to be at the few
/// that remain.
constexpr double near_axis_cells = 2;

/// A part of an axis [m].
struct Stretch {
  double low, high;
};

/// Finds the range of the particles along an axis that are connected to the median by strips of a given width that all hold a
/// part of a particle. Only those count that stand in `domain`, or at most a strip beside it: those of a failed run may be
/// anywhere.
class ConnectedRange {
 public:
  ConnectedRange(const Stretch& domain, double width)
      : width_(width), per_width_(1 / width), least_(domain.low - width), most_(domain.high + width) {
    // Strips on either side of the domain: one may have centres, `range` looks three farther.
    constexpr long around = 5;
    first_ = strip_of(domain.low) - around;
    strips_.resize(std::size_t(strip_of(domain.high) + around + 1 - first_));
  }

  /// `half`: of the particle's size.
  void add(double centre, double half) {
    if (!(centre > least_ && centre < most_)) return;
    Strip& strip = strips_[std::size_t(strip_of(centre) - first_)];
    strip.n_centres += 1;
    strip.low = std::min(strip.low, centre - half);
    strip.high = std::max(strip.high, centre + half);
    ++n_;
  }

  /// How many particles count.
  long n() const { return n_; }
  /// [0, 0] if none does.
  Stretch range() const {
    if (n_ == 0) return {0, 0};
    std::size_t median = 0;
    for (long before = strips_[0].n_centres; before <= n_ / 2; before += strips_[median].n_centres) ++median;
    Stretch found{infinite, -infinite};
    const auto extend = [&](const Strip& strip) {
      found.low = std::min(found.low, strip.low);
      found.high = std::max(found.high, strip.high);
    };
    for (std::size_t k = median; holds_material(k); ++k) extend(strips_[k]);
    for (std::size_t k = median; holds_material(k); --k) extend(strips_[k]);
    return found;
  }

 private:
  static constexpr double infinite = std::numeric_limits<double>::infinity();
  struct Strip {
    double low = infinite, high = -infinite;  ///< of the particles whose centres it has [m]
    long n_centres = 0;
  };
  /// A centre, or part of a particle with its centre in the strip beside it. Farther ones do not count, as grains that fly apart
  /// fill any volume, nor does what ends at the strip's edge, however it is rounded.
  bool holds_material(std::size_t k) const {
    const double low = double(first_ + long(k)) * width_, high = low + width_, rounding = 1e-12 * width_;
    return strips_[k].n_centres > 0 || strips_[k - 1].high - rounding > low || strips_[k + 1].low + rounding < high;
  }
  long strip_of(double x) const {  // std::floor takes longer
    const double share = x * per_width_;
    const long towards_zero = long(share);
    return towards_zero - (share < double(towards_zero));
  }

  double width_, per_width_, least_, most_;
  long first_, n_ = 0;
  std::vector<Strip> strips_;
};

/// Surface from the first to the last patch that holds material, and an empty one beyond each, so that the surface falls to
/// zero. Neighbours that hold material exchange a quarter of their difference in thickness, (1, 2, 1)/4: rows of particles
/// are divided unevenly among patches, so the thickness alternates from one to the next. The volume is conserved, and a flat
/// surface stays flat.
Surface surface_of(const Patches& patches) {
  const auto from_neighbour = [&](int i, int j) {
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
    surface.thickness.push_back(own == 0 ? 0 : own + from_neighbour(i, i - 1) + from_neighbour(i, i + 1));
  }
  return surface;
}

}  // namespace

OutlineFinder::OutlineFinder(const Case& case_, const ParticlePlaces& start)
    : dim_(case_.dim),
      cell_(case_.cell),
      floor_(case_.domain.min[case_.dim - 1]),
      level_(*case_.output.front_thickness),
      axisymmetric_(case_.axisymmetric),
      domain_(case_.domain),
      n_cells_(case_.n_cells),
      axis_{},
      angle_(case_.axisymmetric ? 1 : 2 * std::numbers::pi) {
  for (const Vec<3>& x : start.places) axis_ = axis_ + (1.0 / double(start.places.size())) * x;
  if (axisymmetric_) axis_ = {};
  start_.resize(start.sizes.size());
  for (std::size_t i = 0; i < start_.size(); ++i) {
    const std::size_t id = start.ancestors.empty() ? i : std::size_t(start.ancestors[i]);
    start_.at(id) = {start.sizes[i] / 2, start.masses.empty() ? 1 : start.masses[i]};
  }
  for (int a = 0; a < case_.dim - 1; ++a) {  // the axis of a body that a plane of symmetry cuts lies in the plane
    const bool low = case_.walls[2 * a].kind == WallKind::symmetry,
               high = case_.walls[2 * a + 1].kind == WallKind::symmetry;
    if (low) axis_[a] = case_.domain.min[a];
    if (high) axis_[a] = case_.domain.max[a];
    if (low || high) angle_ /= 2;
  }
}

double OutlineFinder::half_size_of(const ParticlePlaces& particles, std::size_t i) const {
  if (particles.ancestors.empty()) return start_[i].half_size;
  const AtStart& ancestor = start_[std::size_t(particles.ancestors[i])];
  const double share = particles.masses[i] / ancestor.mass;
  return share == 1 ? ancestor.half_size : size_of_particle(share, 1, dim_) * ancestor.half_size;
}

double OutlineFinder::radius_of(const Vec<3>& place) const {
  double r2 = 0;
  for (int a = 0; a < dim_ - 1; ++a) r2 += (place[a] - axis_[a]) * (place[a] - axis_[a]);
  return std::sqrt(r2);
}

double OutlineFinder::largest_radius() const {
  double radius = 0;
  for (int a = 0; a < dim_ - 1; ++a)
    radius = std::hypot(radius, std::max(domain_.max[a] - axis_[a], axis_[a] - domain_.min[a]));
  return radius;
}

Patches OutlineFinder::ground(const ParticlePlaces& particles) const {
  const bool plane = dim_ == 2;
  Patches patches({domain_.min[0], plane ? 0 : domain_.min[1]}, {n_cells_[0], plane ? 1 : n_cells_[1]}, cell_);
  for (int i = 0; i < patches.n(); ++i)
    for (int j = 0; j < (plane ? 1 : n_cells_[1]); ++j) patches.at(i, j).area = plane ? cell_ : cell_ * cell_;
  for (std::size_t p = 0; p < particles.places.size(); ++p) {
    const Vec<3>& x = particles.places[p];
    const double size = particles.sizes[p], half = size / 2;
    // The part of a particle beyond a wall or a plane of symmetry counts on this side of it.
    const auto inside = [&](int a) {
      return std::min(x[a] + half, domain_.max[a]) - std::max(x[a] - half, domain_.min[a]);
    };
    patches.divide(0, x[0] - half, x[0] + half, [&](int i, double low, double high) {
      const double slice = (high - low) / inside(0) * size * size;
      if (plane) {
        patches.at(i).add(slice, 0, low, high);
      } else {
        patches.divide(1, x[1] - half, x[1] + half, [&](int j, double near, double far) {
          patches.at(i, j).add(slice * (far - near) / inside(1) * size, 0, low, high);
          patches.at(i, j).stretch(1, near, far);
        });
      }
    });
  }
  return patches;
}

Patches OutlineFinder::rings(const ParticlePlaces& particles) const {
  const double nearest = axisymmetric_ ? domain_.min[0] : 0;
  Patches patches({nearest, 0}, {int(std::ceil((largest_radius() - nearest) / cell_ * (1 - 1e-12))), 1}, cell_);
  for (int i = 0; i < patches.n(); ++i) patches.at(i).area = angle_ * cell_ * patches.middle(i);
  for (std::size_t p = 0; p < particles.places.size(); ++p) {
    const double r = radius_of(particles.places[p]), size = particles.sizes[p];
    const double near = std::max(0.0, r - size / 2), far = r + size / 2;
    const double volume = axisymmetric_ ? size * size * r : size * size * size;
    patches.divide(0, near, far, [&](int i, double low, double high) {  // equally thick, so by area
      patches.at(i).add(volume * (high * high - low * low) / (far * far - near * near), 0, low, high);
    });
  }
  return patches;
}

void OutlineFinder::find_fronts_along_axes(const ParticlePlaces& particles, Outline& outline) const {
  const Patches patches = ground(particles);
  const std::vector<bool> deposit = patches.deposit(level_);
  for (int a = 0; a < dim_ - 1; ++a) {
    outline.front_min[a] = patches.front(deposit, level_, a, 0);
    outline.front_max[a] = patches.front(deposit, level_, a, 1);
  }
  if (dim_ == 2) outline.surface = surface_of(patches);
}

void OutlineFinder::find_fronts_around_axis(const ParticlePlaces& particles, Outline& outline) const {
  const Patches patches = rings(particles);
  const std::vector<bool> deposit = patches.deposit(level_);
  outline.front_radius = patches.front(deposit, level_, 0, 1);
  if (axisymmetric_) {
    outline.front_min[0] = patches.front(deposit, level_, 0, 0);
    outline.front_max[0] = outline.front_radius;
  }
  outline.surface = surface_of(patches);
}

void OutlineFinder::find_farthest(const ParticlePlaces& particles, Outline& outline) const {
  const int up = dim_ - 1;
  const auto along_axis = [&](int a) { return ConnectedRange({domain_.min[a], domain_.max[a]}, cell_); };
  ConnectedRange ranges[3] = {along_axis(0), along_axis(1), along_axis(up)};  // in 2D two of them
  ConnectedRange upwards_at_axis = along_axis(up), outwards({0, largest_radius()}, cell_);
  for (std::size_t i = 0; i < particles.places.size(); ++i) {
    const Vec<3>& place = particles.places[i];
    const double half = half_size_of(particles, i), radius = radius_of(place);
    for (int a = 0; a < dim_; ++a) ranges[a].add(place[a], half);
    if (dim_ == 3) outwards.add(radius, half);
    if (radius <= near_axis_cells * cell_) upwards_at_axis.add(place[up], half);
  }
  for (int a = 0; a < up; ++a) {
    const Stretch range = ranges[a].range();
    outline.farthest_min[a] = range.low;
    outline.farthest_max[a] = range.high;
  }
  outline.height = ranges[up].range().high - floor_;
  outline.height_at_axis = upwards_at_axis.n() == 0 ? 0 : upwards_at_axis.range().high - floor_;
  if (dim_ == 3) outline.farthest_radius = outwards.range().high;
  if (axisymmetric_) outline.farthest_radius = outline.farthest_max[0];
}

Outline OutlineFinder::find(const ParticlePlaces& particles) const {
  Outline outline;
  // Other members of the outline than the other thread's.
  auto farthest = std::async(std::launch::async, [&] { find_farthest(particles, outline); });
  if (!axisymmetric_) find_fronts_along_axes(particles, outline);
  if (dim_ == 3 || axisymmetric_) find_fronts_around_axis(particles, outline);
  farthest.get();
  return outline;
}

}  // namespace talus
