#include "talus/geometry/terrain.hpp"

#include <algorithm>
#include <array>
#include <cassert>
#include <functional>
#include <numeric>

namespace talus {

namespace {

/// Fills pixels without a value from the known ones outwards, each with the mean of its neighbours.
void fill_unknown(PlanRaster& r) {
  std::vector<std::size_t> ring;
  for (std::size_t i = 0; i < r.values.size(); ++i)
    if (std::isnan(r.values[i])) ring.push_back(i);
  while (!ring.empty()) {
    std::vector<std::size_t> left;
    std::vector<std::pair<std::size_t, double>> found;
    for (const std::size_t i : ring) {
      const int column = int(i % std::size_t(r.columns)), row = int(i / std::size_t(r.columns));
      double sum = 0;
      int n = 0;
      for (int dr = -1; dr <= 1; ++dr)
        for (int dc = -1; dc <= 1; ++dc)
          if (r.has(column + dc, row + dr)) {
            sum += r.at(column + dc, row + dr);
            ++n;
          }
      if (n > 0)
        found.emplace_back(i, sum / n);
      else
        left.push_back(i);
    }
    if (found.empty()) return;
    for (const auto& [i, value] : found) r.values[i] = value;
    ring = std::move(left);
  }
}

/// Numbers the gaps of a raster, the largest first, those as large in their order from the south-west: for every pixel the
/// number of its gap, -1 outside gaps; empty if there is none. Returns how many there are.
int number_gaps(const PlanRaster& r, std::vector<int>& gap_of_pixel) {
  constexpr int none = -1, unnumbered = -2;
  if (std::ranges::none_of(r.values, [](double z) { return std::isnan(z); })) return 0;
  for (const double z : r.values) gap_of_pixel.push_back(std::isnan(z) ? unnumbered : none);
  std::vector<std::size_t> sizes, next;
  for (std::size_t i = 0; i < gap_of_pixel.size(); ++i) {
    const auto take = [&](std::size_t pixel) {
      if (gap_of_pixel[pixel] != unnumbered) return;
      gap_of_pixel[pixel] = int(sizes.size()) - 1;
      ++sizes.back();
      next.push_back(pixel);
    };
    if (gap_of_pixel[i] != unnumbered) continue;
    sizes.push_back(0);
    take(i);
    while (!next.empty()) {
      const int column = int(next.back() % std::size_t(r.columns)), row = int(next.back() / std::size_t(r.columns));
      next.pop_back();
      for (int dr = -1; dr <= 1; ++dr)
        for (int dc = -1; dc <= 1; ++dc)
          if (r.has_pixel(column + dc, row + dr)) take(r.index(column + dc, row + dr));
    }
  }
  std::vector<std::size_t> order(sizes.size());
  std::iota(order.begin(), order.end(), std::size_t(0));
  std::ranges::stable_sort(order, std::greater(), [&](std::size_t gap) { return sizes[gap]; });
  std::vector<int> rank(sizes.size());
  for (std::size_t i = 0; i < order.size(); ++i) rank[order[i]] = int(i);
  for (int& gap : gap_of_pixel)
    if (gap != none) gap = rank[std::size_t(gap)];
  return int(sizes.size());
}

/// Calls f(first, step, n) for every row of a raster, or for every column.
template <class F>
void for_each_line(const PlanRaster& r, bool rows, F f) {
  if (rows)
    for (int row = 0; row < r.rows; ++row) f(r.index(0, row), 1, r.columns);
  else
    for (int column = 0; column < r.columns; ++column) f(r.index(column, 0), std::size_t(r.columns), r.rows);
}

/// Means over `width` pixels along a line; towards its ends over as many as there are on either side.
void smooth(std::vector<double>& values, std::size_t first, std::size_t step, int n, double width) {
  std::vector<double> before(std::size_t(n) + 1, 0.0);  // sums of all pixels before
  for (int i = 0; i < n; ++i)
    before[std::size_t(i) + 1] = before[std::size_t(i)] + values[first + std::size_t(i) * step];
  const auto sum_until = [&](double place) {  // in pixels from the line's beginning
    const int i = std::min(int(place), n - 1);
    return before[std::size_t(i)] + (place - i) * (before[std::size_t(i) + 1] - before[std::size_t(i)]);
  };
  for (int i = 0; i < n; ++i) {
    const double middle = i + 0.5, half = std::min({0.5 * width, middle, n - middle});
    values[first + std::size_t(i) * step] = (sum_until(middle + half) - sum_until(middle - half)) / (2 * half);
  }
}

/// Coefficients c of the spline (c[i-1] + 4 c[i] + c[i+1])/6 = values[i] along a line; without curvature at its ends,
/// where c is the value itself (Thomas' algorithm).
void solve(std::vector<double>& values, std::size_t first, std::size_t step, int n) {
  const auto at = [&](int i) -> double& { return values[first + std::size_t(i) * step]; };
  std::vector<double> above(std::size_t(n), 0.0);
  for (int i = 1; i < n - 1; ++i) {
    const double pivot = 4 - above[std::size_t(i) - 1];
    above[std::size_t(i)] = 1 / pivot;
    at(i) = (6 * at(i) - at(i - 1)) / pivot;
  }
  for (int i = n - 2; i > 0; --i) at(i) -= above[std::size_t(i)] * at(i + 1);
}

/// Weights of four coefficients, and their derivatives, a share `t` of a pixel beyond the second of them.
struct SplineWeights {
  std::array<double, 4> value, slope;
  explicit SplineWeights(double t) {
    const double s = 1 - t;
    value = {s * s * s / 6, 2. / 3 - t * t * (1 - 0.5 * t), 2. / 3 - s * s * (1 - 0.5 * s), t * t * t / 6};
    slope = {-0.5 * s * s, -t * (2 - 1.5 * t), s * (2 - 1.5 * s), 0.5 * t * t};
  }
};

}  // namespace

Terrain::Terrain(PlanRaster heights, double smoothed_over, const std::vector<char>& left_out)
    : heights_(std::move(heights)), lowest_(INFINITY), highest_(-INFINITY), steepest_(0) {
  assert(heights_.columns >= 2 && heights_.rows >= 2);
  PlanRaster inner = heights_;
  for (std::size_t i = 0; i < left_out.size(); ++i)
    if (left_out[i]) heights_.values[i] = PlanRaster::none;
  for (const double z : heights_.values)
    if (!std::isnan(z)) {
      lowest_ = std::min(lowest_, z);
      highest_ = std::max(highest_, z);
    }
  n_gaps_ = number_gaps(heights_, gap_of_pixel_);
  fill_unknown(inner);
  if (const double width = smoothed_over / inner.pixel; width > 1)
    for (const bool rows : {true, false})
      for_each_line(inner, rows, [&](auto first, auto step, int n) { smooth(inner.values, first, step, n, width); });
  for (int row = 0; row < inner.rows; ++row)
    for (int column = 0; column < inner.columns; ++column) {
      const double dx = column > 0 ? inner.at(column, row) - inner.at(column - 1, row) : 0;
      const double dy = row > 0 ? inner.at(column, row) - inner.at(column, row - 1) : 0;
      steepest_ = std::max(steepest_, std::hypot(dx, dy) / inner.pixel);
    }
  for (const bool rows : {true, false})
    for_each_line(inner, rows, [&](auto first, auto step, int n) { solve(inner.values, first, step, n); });
  // One more coefficient around, without curvature across the edge.
  const int columns = inner.columns + 2;
  coefficients_.resize(std::size_t(columns) * std::size_t(inner.rows + 2));
  const auto c = [&](int column, int row) -> double& {
    return coefficients_[std::size_t(row + 1) * std::size_t(columns) + std::size_t(column + 1)];
  };
  for (int row = 0; row < inner.rows; ++row) {
    for (int column = 0; column < inner.columns; ++column) c(column, row) = inner.at(column, row);
    c(-1, row) = 2 * c(0, row) - c(1, row);
    c(inner.columns, row) = 2 * c(inner.columns - 1, row) - c(inner.columns - 2, row);
  }
  for (int column = -1; column <= inner.columns; ++column) {
    c(column, -1) = 2 * c(column, 0) - c(column, 1);
    c(column, inner.rows) = 2 * c(column, inner.rows - 1) - c(column, inner.rows - 2);
  }
}

TerrainPlace Terrain::at(double x, double y) const {
  // In pixels from the middle of the first.
  const double u = (x - heights_.corner[0]) / heights_.pixel - 0.5, v = (y - heights_.corner[1]) / heights_.pixel - 0.5;
  const double u_in = std::clamp(u, 0.0, heights_.columns - 1.0), v_in = std::clamp(v, 0.0, heights_.rows - 1.0);
  const int column = std::min(int(u_in), heights_.columns - 2), row = std::min(int(v_in), heights_.rows - 2);
  const SplineWeights along_x(u_in - column), along_y(v_in - row);
  double z = 0, dx = 0, dy = 0, twist = 0;  // twist: how dx varies along y
  const std::size_t width = std::size_t(heights_.columns) + 2;
  const double* c = coefficients_.data() + std::size_t(row) * width + std::size_t(column);
  for (std::size_t j = 0; j < 4; ++j, c += width) {
    const double value =
        along_x.value[0] * c[0] + along_x.value[1] * c[1] + along_x.value[2] * c[2] + along_x.value[3] * c[3];
    const double slope =
        along_x.slope[0] * c[0] + along_x.slope[1] * c[1] + along_x.slope[2] * c[2] + along_x.slope[3] * c[3];
    z += along_y.value[j] * value;
    dx += along_y.value[j] * slope;
    dy += along_y.slope[j] * value;
    twist += along_y.slope[j] * slope;
  }
  // Beyond the middles of the outer pixels the surface is extrapolated linearly.
  const double du = u - u_in, dv = v - v_in, z_beyond = z + dx * du + dy * dv;
  if (dv == 0) dy += twist * du;
  if (du == 0) dx += twist * dv;
  return {z_beyond, dx / heights_.pixel, dy / heights_.pixel};
}

}  // namespace talus
