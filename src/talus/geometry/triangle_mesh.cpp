#include "talus/geometry/triangle_mesh.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <atomic>
#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <unordered_map>
#include <utility>

namespace talus {

namespace {

constexpr double nowhere = std::numeric_limits<double>::infinity();

/// A triangle has no area if its height is less than this share of its longest edge.
constexpr double least_height = 1e-9;

Vec<3> to_unit_length(const Vec<3>& v) {
  const double l = length(v);
  return l > 0 ? (1 / l) * v : v;
}

struct HashOfPlace {
  std::size_t operator()(const Vec<3>& x) const {
    std::uint64_t h = 0;
    for (int a = 0; a < 3; ++a) h = (h ^ std::bit_cast<std::uint64_t>(x[a])) * 0x9E3779B97F4A7C15 + (h >> 29);
    return std::size_t(h);
  }
};

/// The square of the distance from a point to a box.
double distance_squared(const Vec<3>& x, const Vec<3>& low, const Vec<3>& high) {
  double sum = 0;
  for (int a = 0; a < 3; ++a) {
    const double d = std::max({low[a] - x[a], x[a] - high[a], 0.0});
    sum += d * d;
  }
  return sum;
}

enum class Feature { corner, edge, face };

/// The place of a triangle that is nearest to a point.
struct Foot {
  double squared = nowhere;  ///< of the distance
  Feature feature = Feature::face;
  int k = 0;     ///< which corner, or which edge
  Vec<3> off{};  ///< from the place to the point
};

Foot foot_on(const std::array<Vec<3>, 3>& c, const Vec<3>& normal, const Vec<3>& x) {
  Foot foot;
  bool beside = false;
  for (int k = 0; k < 3; ++k) {
    const Vec<3>& a = c[std::size_t(k)];
    const Vec<3> edge = c[std::size_t((k + 1) % 3)] - a, from = x - a;
    if (dot(from, cross(edge, normal)) < 0) continue;  // the point is on the inner side of the edge
    beside = true;
    const double s = dot(from, edge) / dot(edge, edge);
    const Vec<3> off = s <= 0 ? from : s >= 1 ? from - edge : from - s * edge;
    const double squared = dot(off, off);
    if (squared < foot.squared)
      foot = {squared, s <= 0 || s >= 1 ? Feature::corner : Feature::edge, s >= 1 ? (k + 1) % 3 : k, off};
  }
  if (beside) return foot;
  const double height = dot(x - c[0], normal);
  return {height * height, Feature::face, 0, height * normal};
}

}  // namespace

TriangleMesh::TriangleMesh(const std::vector<Vec<3>>& corners_of_triangles) {
  std::unordered_map<Vec<3>, int, HashOfPlace> numbers;
  const auto number_of = [&](Vec<3> x) {
    for (int a = 0; a < 3; ++a) x[a] += 0.0;  // -0 is 0
    const auto [at, is_new] = numbers.emplace(x, int(corners_.size()));
    if (is_new) corners_.push_back(x);
    return at->second;
  };
  for (std::size_t i = 0; i + 2 < corners_of_triangles.size(); i += 3) {
    const std::array<int, 3> t{number_of(corners_of_triangles[i]), number_of(corners_of_triangles[i + 1]),
                               number_of(corners_of_triangles[i + 2])};
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0])
      ++left_out_;
    else
      triangles_.push_back(t);
  }
  low_ = {nowhere, nowhere, nowhere};
  high_ = -1.0 * low_;
  for (const Vec<3>& x : corners_)
    for (int a = 0; a < 3; ++a) {
      low_[a] = std::min(low_[a], x[a]);
      high_[a] = std::max(high_[a], x[a]);
    }
  prepare();
}

void TriangleMesh::prepare() {
  static std::atomic<std::uint64_t> versions{0};
  version_ = ++versions;
  find_normals();
  build_tree();
}

void TriangleMesh::find_normals() {
  normals_.assign(triangles_.size(), {});
  edge_normals_.assign(triangles_.size(), {});
  corner_normals_.assign(corners_.size(), {});
  std::map<std::pair<int, int>, Vec<3>> of_edges;
  const auto key = [](int a, int b) { return std::pair(std::min(a, b), std::max(a, b)); };
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    const auto& c = triangles_[t];
    std::array<Vec<3>, 3> edges;
    double longest = 0;
    for (std::size_t k = 0; k < 3; ++k) {
      edges[k] = corners_[std::size_t(c[(k + 1) % 3])] - corners_[std::size_t(c[k])];
      longest = std::max(longest, dot(edges[k], edges[k]));
    }
    const Vec<3> twice_area = cross(edges[0], edges[1]);
    if (!(length(twice_area) > least_height * longest)) continue;
    normals_[t] = to_unit_length(twice_area);
    for (std::size_t k = 0; k < 3; ++k) {
      Vec<3>& of_edge = of_edges[key(c[k], c[(k + 1) % 3])];
      of_edge = of_edge + normals_[t];
      const Vec<3> there = edges[k], back = -1.0 * edges[(k + 2) % 3];
      const double angle = std::atan2(length(cross(there, back)), dot(there, back));
      Vec<3>& of_corner = corner_normals_[std::size_t(c[k])];
      of_corner = of_corner + angle * normals_[t];
    }
  }
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    for (std::size_t k = 0; k < 3; ++k)
      edge_normals_[t][k] = to_unit_length(of_edges[key(triangles_[t][k], triangles_[t][(k + 1) % 3])]);
  for (Vec<3>& n : corner_normals_) n = to_unit_length(n);
}

void TriangleMesh::build_tree() {
  constexpr int most_in_leaf = 4;
  order_.clear();
  for (std::size_t t = 0; t < triangles_.size(); ++t)
    if (dot(normals_[t], normals_[t]) > 0) order_.push_back(int(t));
  tree_.clear();
  if (order_.empty()) return;
  const auto middle = [&](int t, int axis) {
    double sum = 0;
    for (const int c : triangles_[std::size_t(t)]) sum += corners_[std::size_t(c)][axis];
    return sum;
  };
  tree_.push_back({{}, {}, 0, int(order_.size())});
  for (std::size_t n = 0; n < tree_.size(); ++n) {
    Node node = tree_[n];
    node.low = {nowhere, nowhere, nowhere};
    node.high = -1.0 * node.low;
    const auto first = order_.begin() + node.first, last = first + node.count;
    for (auto t = first; t != last; ++t)
      for (const int c : triangles_[std::size_t(*t)])
        for (int a = 0; a < 3; ++a) {
          node.low[a] = std::min(node.low[a], corners_[std::size_t(c)][a]);
          node.high[a] = std::max(node.high[a], corners_[std::size_t(c)][a]);
        }
    if (node.count > most_in_leaf) {
      int longest = 0;
      for (int a = 1; a < 3; ++a)
        if (node.high[a] - node.low[a] > node.high[longest] - node.low[longest]) longest = a;
      const int half = node.count / 2;
      std::nth_element(first, first + half, last, [&](int s, int t) {
        return std::pair(middle(s, longest), s) < std::pair(middle(t, longest), t);
      });
      tree_.push_back({{}, {}, node.first, half});
      tree_.push_back({{}, {}, node.first + half, node.count - half});
      node.first = int(tree_.size()) - 2;
      node.count = 0;
    }
    tree_[n] = node;
  }
}

std::string TriangleMesh::fault() const {
  const auto place_of = [&](int corner) {
    const Vec<3>& x = corners_[std::size_t(corner)];
    return fmt::format("({:.6g}, {:.6g}, {:.6g}) m", x[0], x[1], x[2]);
  };
  if (triangles_.empty()) return "has no triangles";
  long flat = 0;
  int first_flat = 0;
  std::map<std::pair<int, int>, std::pair<int, int>> uses;  // number of uses of an edge in each direction
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    if (normals_[t] == Vec<3>{} && flat++ == 0) first_flat = triangles_[t][0];
    for (std::size_t k = 0; k < 3; ++k) {
      const int a = triangles_[t][k], b = triangles_[t][(k + 1) % 3];
      if (a < b)
        ++uses[{a, b}].first;
      else
        ++uses[{b, a}].second;
    }
  }
  if (flat > 0)
    return fmt::format(
        "has {} triangle{} without area, the first at {}; remove them with a program that repairs meshes", flat,
        flat == 1 ? "" : "s", place_of(first_flat));
  long open = 0, crowded = 0, turned = 0;
  int at_open = 0, at_crowded = 0, at_turned = 0;
  for (const auto& [edge, n] : uses) {
    if (n.first + n.second == 1 && open++ == 0) at_open = edge.first;
    if (n.first + n.second > 2 && crowded++ == 0) at_crowded = edge.first;
    if (n.first + n.second == 2 && n.first != 1 && turned++ == 0) at_turned = edge.first;
  }
  if (open > 0)
    return fmt::format(
        "is not closed: {} edge{} of one triangle only, the first at {}; a solid needs a surface "
        "without holes, whose triangles share their corners exactly",
        open, open == 1 ? " is that" : "s are those", place_of(at_open));
  if (crowded > 0)
    return fmt::format(
        "has {} edge{} that more than two triangles share, the first at {}; make parts that touch one "
        "body, or files of their own",
        crowded, crowded == 1 ? "" : "s", place_of(at_crowded));
  if (turned > 0)
    return fmt::format(
        "has triangles that show their inner side beside others that show their outer one, first at {} "
        "({} edges); let the program that wrote it orient its faces",
        place_of(at_turned), turned);
  return "";
}

double TriangleMesh::volume() const {
  double six = 0;
  for (const auto& t : triangles_)
    six += dot(corners_[std::size_t(t[0])] - low_,
               cross(corners_[std::size_t(t[1])] - low_, corners_[std::size_t(t[2])] - low_));
  return six / 6;
}

void TriangleMesh::turn_round() {
  for (auto& t : triangles_) std::swap(t[1], t[2]);
  prepare();
}

TriangleMesh::Place TriangleMesh::nearest(const Vec<3>& x) const {
  Vec<3> off{};
  for (int a = 0; a < 3; ++a) off[a] = x[a] < low_[a] ? x[a] - low_[a] : x[a] > high_[a] ? x[a] - high_[a] : 0;
  if (const double far = length(off); far > length(high_ - low_)) return {far, (1 / far) * off};
  // If the solid is at rest, nodes of the grid ask for the same places in every step: each thread stores the results.
  struct Told {
    std::uint64_t version = 0;
    Vec<3> x{};
    Place place{};
  };
  constexpr std::size_t most = 1 << 16;
  static thread_local std::vector<Told> told(most);
  Told& here = told[(HashOfPlace()(x) >> 7) % most];
  if (here.version != version_ || !(here.x == x)) here = {version_, x, find_nearest(x)};
  return here.place;
}

TriangleMesh::Place TriangleMesh::find_nearest(const Vec<3>& x) const {
  Foot best;
  int best_triangle = -1;
  std::array<std::pair<int, double>, 128> stack;  // deeper than any tree
  std::size_t n = 0;
  if (!tree_.empty()) stack[n++] = {0, distance_squared(x, tree_[0].low, tree_[0].high)};
  while (n > 0) {
    const auto [at, squared] = stack[--n];
    if (squared > best.squared) continue;
    const Node& node = tree_[std::size_t(at)];
    if (node.count == 0) {
      std::pair<int, double> a{node.first, 0}, b{node.first + 1, 0};
      for (auto* child : {&a, &b}) {
        const Node& c = tree_[std::size_t(child->first)];
        child->second = distance_squared(x, c.low, c.high);
      }
      if (a.second < b.second) std::swap(a, b);
      stack[n++] = a;
      stack[n++] = b;  // the nearer first
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const int t = order_[std::size_t(i)];
      const auto& c = triangles_[std::size_t(t)];
      const Foot foot = foot_on({corners_[std::size_t(c[0])], corners_[std::size_t(c[1])], corners_[std::size_t(c[2])]},
                                normals_[std::size_t(t)], x);
      if (foot.squared < best.squared || (foot.squared == best.squared && t < best_triangle)) {
        best = foot;
        best_triangle = t;
      }
    }
  }
  if (best_triangle < 0) return {nowhere, {0, 0, 1}};
  const auto t = std::size_t(best_triangle), k = std::size_t(best.k);
  const Vec<3>& normal = best.feature == Feature::face   ? normals_[t]
                         : best.feature == Feature::edge ? edge_normals_[t][k]
                                                         : corner_normals_[std::size_t(triangles_[t][k])];
  const double height = dot(best.off, normal);
  if (best.feature == Feature::face) return {height, normal};
  const double distance = std::copysign(std::sqrt(best.squared), height);
  // This close to the surface the direction consists of rounding errors.
  if (std::abs(distance) < 1e-9 * length(high_ - low_)) return {distance, normal};
  return {distance, (1 / distance) * best.off};
}

std::vector<double> TriangleMesh::heights_at(double x, double y) const {
  std::vector<double> heights;
  const Vec<2> at{x, y};
  std::vector<int> left;
  if (!tree_.empty()) left.push_back(0);
  while (!left.empty()) {
    const Node& node = tree_[std::size_t(left.back())];
    left.pop_back();
    if (x < node.low[0] || x > node.high[0] || y < node.low[1] || y > node.high[1]) continue;
    if (node.count == 0) {
      left.push_back(node.first);
      left.push_back(node.first + 1);
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const auto t = std::size_t(order_[std::size_t(i)]);
      const Vec<3>& normal = normals_[t];
      if (std::abs(normal[2]) < 1e-12) continue;  // seen from above it has no area
      bool inside = true;
      double low = nowhere, high = -nowhere;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec<3>&a = corners_[std::size_t(triangles_[t][k])],
              &b = corners_[std::size_t(triangles_[t][(k + 1) % 3])];
        const double side = (b[0] - a[0]) * (at[1] - a[1]) - (b[1] - a[1]) * (at[0] - a[0]);
        inside &= side * normal[2] >= 0;
        low = std::min(low, a[2]);
        high = std::max(high, a[2]);
      }
      if (!inside) continue;
      const Vec<3>& a = corners_[std::size_t(triangles_[t][0])];
      heights.push_back(std::clamp(a[2] - (normal[0] * (x - a[0]) + normal[1] * (y - a[1])) / normal[2], low, high));
    }
  }
  std::sort(heights.begin(), heights.end());
  const double one = 1e-9 * length(high_ - low_);
  heights.erase(std::unique(heights.begin(), heights.end(), [&](double a, double b) { return b - a <= one; }),
                heights.end());
  return heights;
}

double TriangleMesh::first_hit(const Vec<3>& from, const Vec<3>& direction, int except) const {
  double first = nowhere;
  std::vector<int> left{0};
  while (!left.empty()) {
    const Node& node = tree_[std::size_t(left.back())];
    left.pop_back();
    double begin = 0, end = first;  // of the way through the box
    for (int a = 0; a < 3; ++a) {
      if (direction[a] == 0) {
        if (from[a] < node.low[a] || from[a] > node.high[a]) end = -1;
        continue;
      }
      const double s = (node.low[a] - from[a]) / direction[a], t = (node.high[a] - from[a]) / direction[a];
      begin = std::max(begin, std::min(s, t));
      end = std::min(end, std::max(s, t));
    }
    if (!(begin <= end)) continue;
    if (node.count == 0) {
      left.push_back(node.first);
      left.push_back(node.first + 1);
      continue;
    }
    for (int i = node.first; i < node.first + node.count; ++i) {
      const int number = order_[std::size_t(i)];
      const auto t = std::size_t(number);
      const double towards = dot(direction, normals_[t]);
      if (number == except || towards == 0) continue;
      const double way = dot(corners_[std::size_t(triangles_[t][0])] - from, normals_[t]) / towards;
      if (!(way >= 0 && way < first)) continue;
      const Vec<3> hit = from + way * direction;
      bool inside = true;
      for (std::size_t k = 0; k < 3; ++k) {
        const Vec<3>& a = corners_[std::size_t(triangles_[t][k])];
        const Vec<3> edge = corners_[std::size_t(triangles_[t][(k + 1) % 3])] - a;
        inside &= dot(hit - a, cross(edge, normals_[t])) <= 1e-12 * dot(edge, edge);
      }
      if (inside) first = way;
    }
  }
  return first;
}

double TriangleMesh::thickness() const {
  std::vector<std::pair<double, double>> thick;  // thickness and area
  double whole = 0;
  for (const int number : order_) {
    const auto& t = triangles_[std::size_t(number)];
    const Vec<3>&a = corners_[std::size_t(t[0])], &b = corners_[std::size_t(t[1])], &c = corners_[std::size_t(t[2])];
    const double area = 0.5 * length(cross(b - a, c - a));
    const Vec<3> middle = (1.0 / 3) * (a + b + c);
    thick.emplace_back(first_hit(middle, -1.0 * normals_[std::size_t(number)], number), area);
    whole += area;
  }
  std::sort(thick.begin(), thick.end());
  double thinner = 0;
  for (const auto& [here, area] : thick)
    if ((thinner += area) > 0.05 * whole) return here;
  return nowhere;
}

}  // namespace talus
