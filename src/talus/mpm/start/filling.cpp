#include "talus/mpm/start/filling.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <random>
#include <utility>
#include <vector>

namespace talus {

namespace {

/// Random numbers that are the same everywhere, which those of the standard's distributions are not.
class Random {
 public:
  explicit Random(int seed) : engine_(std::uint64_t(seed)) {}
  double from_minus_1_to_1() { return double(engine_() >> 11) * 0x1p-52 - 1; }

 private:
  std::mt19937_64 engine_;
};

/// Whether a body fills a shape; others list their particles.
bool is_shape(const BodySpec& body) {
  return !std::holds_alternative<PointList>(body.region) && !std::holds_alternative<SurfaceLayer>(body.region);
}

/// How many planes of the lattice a shape has across each axis.
Index<3> planes_of_lattice(const BodySpec& body, int dim) {
  const Box box = bounding_box(body.region, dim);
  Index<3> n{1, 1, 1};
  for (int a = 0; a < dim; ++a) n[a] = lattice_planes(body, box, a);
  return n;
}

/// Whether places are on the same sides of the planes of symmetry.
bool are_on_same_sides(const Vec<3>& x, const Vec<3>& y, const Box& kept, int dim) {
  for (int a = 0; a < dim; ++a)
    for (const double plane : {kept.min[a], kept.max[a]})
      if ((x[a] - plane) * (y[a] - plane) <= 0) return false;
  return true;
}

/// A place of the lattice scattered along each axis. One that would leave the body, or cross a plane of symmetry, stays.
Vec<3> scattered(const Vec<3>& place, double distance, const BodySpec& body, const Box& kept, int dim, Random& random) {
  Vec<3> x = place;
  for (int a = 0; a < dim; ++a) x[a] += distance * random.from_minus_1_to_1();
  return are_on_same_sides(x, place, kept, dim) && contains(body.region, x, dim) ? x : place;
}

/// Blue noise: of some random places in the same cube of the lattice the one farthest from what already stands in the
/// cubes around (best candidate, Mitchell 1991, Computer Graphics 25:157). With a point in every cube, each part of the body
/// has the mass it should, and there are no rows. Cubes are filled in the order of their parities, so that what stands
/// around one is the same to all sides.
class BlueNoise {
 public:
  /// `middles`: of the cubes, along each axis; nowhere where the body is not.
  BlueNoise(const BodySpec& body, const Box& kept, int dim, const Index<3>& n, const std::vector<Vec<3>>& middles)
      : n_(n), places_(middles.size(), nowhere) {
    Random random(body.seed);
    for (int parity = 0; parity < (1 << dim); ++parity)
      for (int k = parity >> 2 & 1; k < n[2]; k += 2)
        for (int j = parity >> 1 & 1; j < n[1]; j += 2)
          for (int i = parity & 1; i < n[0]; i += 2) {
            const Vec<3>& middle = middles[slot({i, j, k})];
            if (middle == nowhere) continue;
            Candidates some;
            for (int c = 0; c < candidates; ++c)
              some.set(c, scattered(middle, 0.5 * body.spacing, body, kept, dim, random));
            for_each_around({i, j, k}, [&](const Vec<3>& other) { some.see(other); });
            places_[slot({i, j, k})] = some.farthest();
          }
  }

  std::vector<Vec<3>> take_places() { return std::move(places_); }
  static constexpr Vec<3> nowhere{1e300, 1e300, 1e300};

 private:
  static constexpr int candidates = 16;

  std::size_t slot(const Index<3>& at) const {
    return std::size_t(at[0]) + std::size_t(n_[0]) * (std::size_t(at[1]) + std::size_t(n_[1]) * std::size_t(at[2]));
  }
  /// Calls f(place) for what stands in the cubes around one so far.
  template <class F>
  void for_each_around(const Index<3>& at, F f) const {
    for (int k = std::max(0, at[2] - 1); k <= std::min(n_[2] - 1, at[2] + 1); ++k)
      for (int j = std::max(0, at[1] - 1); j <= std::min(n_[1] - 1, at[1] + 1); ++j)
        for (int i = std::max(0, at[0] - 1); i <= std::min(n_[0] - 1, at[0] + 1); ++i)
          if (const Vec<3>& other = places_[slot({i, j, k})]; other != nowhere) f(other);
  }

  /// Places in one cube, axis by axis, and the squared distance of each to the nearest of what stands around it.
  struct Candidates {
    double x[3][candidates], distance[candidates];

    Candidates() { std::fill(distance, distance + candidates, 1e300); }
    void set(int c, const Vec<3>& place) {
      for (int a = 0; a < 3; ++a) x[a][c] = place[a];
    }
    void see(const Vec<3>& other) {
      for (int c = 0; c < candidates; ++c) {
        const double dx = x[0][c] - other[0], dy = x[1][c] - other[1], dz = x[2][c] - other[2];
        distance[c] = std::min(distance[c], dx * dx + dy * dy + dz * dz);
      }
    }
    Vec<3> farthest() const {
      const auto c = std::max_element(distance, distance + candidates) - distance;
      return {x[0][c], x[1][c], x[2][c]};
    }
  };

  Index<3> n_;
  std::vector<Vec<3>> places_;
};

/// Calls f(place, whether it lies in the shape) for the places of the lattice around a shape.
template <class F>
void for_each_place(const Case& case_, const BodySpec& body, F f) {
  const int dim = case_.dim;
  const Box box = bounding_box(body.region, dim);
  const double offset = body.lattice == Lattice::corner ? 0 : 0.5;
  const Index<3> n = planes_of_lattice(body, dim);
  for (int k = 0; k < n[2]; ++k)
    for (int j = 0; j < n[1]; ++j)
      for (int i = 0; i < n[0]; ++i) {
        Vec<3> x{};
        const Index<3> at{i, j, k};
        for (int a = 0; a < dim; ++a) x[a] = box.min[a] + (at[a] + offset) * body.spacing;
        f(x, contains(body.region, x, dim));
      }
}

/// The places of a shape that is filled with blue noise; of others none.
std::vector<Vec<3>> blue_noise(const Case& case_, const BodySpec& body, const Box& kept) {
  if (!is_shape(body) || body.lattice != Lattice::blue_noise) return {};
  std::vector<Vec<3>> middles;
  for_each_place(case_, body,
                 [&](const Vec<3>& x, bool is_inside) { middles.push_back(is_inside ? x : BlueNoise::nowhere); });
  std::vector<Vec<3>> places =
      BlueNoise(body, kept, case_.dim, planes_of_lattice(body, case_.dim), middles).take_places();
  std::erase(places, BlueNoise::nowhere);
  return places;
}

/// Calls f(place, volume) for the particles of a body, on this side of planes of symmetry. Volumes in a shape are relative.
/// `noise`: its blue noise.
template <class F>
void for_each_particle(const Case& case_, const BodySpec& body, const Box& kept, const std::vector<Vec<3>>& noise,
                       F f) {
  const double close = 1e-9 * case_.cell;
  const auto keep = [&](Vec<3> x, double volume) {
    for (int a = 0; a < case_.dim; ++a) {
      if (x[a] < kept.min[a] - close || x[a] > kept.max[a] + close) return;
      const bool on_plane = x[a] <= kept.min[a] + close || x[a] >= kept.max[a] - close;
      if (on_plane) {
        x[a] = std::clamp(x[a], kept.min[a], kept.max[a]);
        volume *= 0.5;
      }
    }
    f(x, volume);
  };
  if (const auto* list = std::get_if<PointList>(&body.region)) {
    for (std::size_t i = 0; i < list->places.size(); ++i) keep(list->places[i], list->volumes[i]);
    return;
  }
  if (const auto* layer = std::get_if<SurfaceLayer>(&body.region)) {
    for_each_point(*layer, keep);
    return;
  }
  const auto keep_place = [&](const Vec<3>& x) { keep(x, case_.axisymmetric ? x[0] : 1); };
  for (const Vec<3>& x : noise) keep_place(x);
  if (body.lattice == Lattice::blue_noise) return;
  Random random(body.seed);
  for_each_place(case_, body, [&](const Vec<3>& x, bool is_inside) {
    if (is_inside)
      keep_place(body.scatter > 0 ? scattered(x, body.scatter * body.spacing, body, kept, case_.dim, random) : x);
  });
}

/// The volume that the particles of a shape share [m3], around an axis per radian.
double volume_to_share(const Case& case_, const BodySpec& body, const Box& kept) {
  if (case_.axisymmetric) return volume_per_radian(body.region);
  const bool is_cut =
      std::ranges::any_of(case_.walls, [](const Wall& wall) { return wall.kind == WallKind::symmetry; });
  return is_cut ? volume(body.region, case_.dim, kept) : volume(body.region, case_.dim);
}

}  // namespace

int lattice_planes(const BodySpec& body, const Box& box, int axis) {
  const double offset = body.lattice == Lattice::corner ? 0 : 0.5;
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

Filling fill(const Case& case_, const BodySpec& body, Part part) {
  const Box kept = kept_by_symmetry(case_);
  const std::vector<Vec<3>> noise = blue_noise(case_, body, kept);
  Filling filling;
  long last = std::numeric_limits<long>::max();
  if (part.of > 1) {
    long n = 0;
    for_each_particle(case_, body, kept, noise, [&](const Vec<3>&, double) { ++n; });
    filling.first = n * part.number / part.of;
    last = n * (part.number + 1) / part.of;
  }
  double sum = 0;
  Vec<3> moment{};
  for_each_particle(case_, body, kept, noise, [&](const Vec<3>& x, double volume) {
    const long number = filling.n_of_body++;
    sum += volume;
    moment = moment + volume * x;
    if (number < filling.first || number >= last) return;
    filling.points.push_back(x);
    filling.volumes.push_back(volume);
  });
  filling.centre = (1 / sum) * moment;
  if (!is_shape(body)) return filling;
  // The points share the exact volume of the region, so its mass is exact whatever the lattice; around an axis in
  // proportion to their radius.
  const double whole = volume_to_share(case_, body, kept);
  for (double& v : filling.volumes) v = whole * v / sum;
  return filling;
}

}  // namespace talus
