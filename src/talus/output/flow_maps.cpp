#include "talus/output/flow_maps.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstdint>
#include <iterator>
#include <stdexcept>

namespace talus {

/// An estimate from the exponent, within 4 %, and Halley's iteration. Twice as fast as std::cbrt, which would be half of
/// the cost of a map.
double width_in_plan(double volume) {
  const double v = volume;
  double y = std::bit_cast<double>(std::bit_cast<std::uint64_t>(v) / 3 + 0x2A9F7893782DA1CE);
  for (int i = 0; i < 2; ++i) {
    const double yyy = y * y * y;
    y *= (yyy + 2 * v) / (2 * yyy + v);
  }
  return y;
}

namespace {

/// The part of an interval that lies on a row of pixels of edge 1, of which there are n.
struct Footprint {
  double low, high;  ///< inside; low >= high if nothing is
  int first, last;   ///< pixels that may be touched: as many for all points as wide, which keeps loops predictable
  double per_length;

  Footprint(double begin, double end, int most, int n)
      : low(std::max(begin, 0.0)), high(std::min(end, double(n))), first(0), last(-1), per_length(1 / (end - begin)) {
    if (!(low < high)) return;
    first = int(low);
    last = std::min(first + most, n) - 1;
  }
  bool is_outside() const { return last < first; }
  /// Of the whole, in a pixel.
  double share_of(int pixel) const {
    return per_length * std::max(0.0, std::min(high, double(pixel + 1)) - std::max(low, double(pixel)));
  }
  double share_inside() const { return per_length * (high - low); }
};

/// Cosine of the ground's slope in the middle of each pixel.
std::vector<double> cosines_of(const Terrain& ground, const PlanRaster& pixels) {
  std::vector<double> cosines;
  cosines.reserve(std::size_t(pixels.columns) * std::size_t(pixels.rows));
  for (int row = 0; row < pixels.rows; ++row)
    for (int column = 0; column < pixels.columns; ++column) {
      const Vec<2> x = pixels.middle(column, row);
      cosines.push_back(ground.at(x[0], x[1]).cosine());
    }
  return cosines;
}

}  // namespace

FlowColumns::FlowColumns(PlanRaster pixels, std::vector<double> cosines, double least_thickness)
    : pixels_(std::move(pixels)), cosines_(std::move(cosines)), least_thickness_(least_thickness) {
  columns_.resize(std::size_t(pixels_.columns) * std::size_t(pixels_.rows));
  assert(cosines_.size() == columns_.size());
  touched_.assign(std::size_t(pixels_.rows), {pixels_.columns, 0});
  pixels_.values = {};
}

FlowMaps::FlowMaps(const Terrain& ground, PlanRaster pixels, double interval, double least_thickness,
                   std::span<const double> state)
    : interval_(interval), columns_(pixels, cosines_of(ground, pixels), least_thickness) {
  assert(interval > 0);
  const std::size_t n = std::size_t(pixels.columns) * std::size_t(pixels.rows);
  pixels.values.assign(n, PlanRaster::none);
  peak_speed_ = peak_pressure_ = arrival_ = pixels;
  peak_thickness_ = std::move(pixels);
  peak_thickness_.values.assign(n, 0);

  if (state.empty()) return;
  const PlanRaster& p = peak_thickness_;
  const double head[] = {p.corner[0], p.corner[1], p.pixel, double(p.columns), double(p.rows)};
  if (state.size() < std::size(head) + 2 || !std::equal(std::begin(head), std::end(head), state.begin()))
    throw std::runtime_error("the maps of the stopped run have other pixels");
  state = state.subspan(std::size(head));
  next_ = state[0];
  peak_volume_outside_ = state[1];
  for (state = state.subspan(2); state.size() >= 5; state = state.subspan(5)) {
    const auto pixel = std::size_t(state[0]);
    peak_thickness_.values[pixel] = state[1];
    peak_speed_.values[pixel] = state[2];
    peak_pressure_.values[pixel] = state[3];
    arrival_.values[pixel] = state[4];
  }
}

std::vector<double> FlowMaps::state() const {
  const PlanRaster& p = peak_thickness_;
  std::vector<double> all = {p.corner[0], p.corner[1],         p.pixel, double(p.columns), double(p.rows),
                             next_,       peak_volume_outside_};
  for (std::size_t i = 0; i < p.values.size(); ++i)
    if (p.values[i] > 0)
      all.insert(all.end(),
                 {double(i), p.values[i], peak_speed_.values[i], peak_pressure_.values[i], arrival_.values[i]});
  return all;
}

void FlowColumns::gather(const FlowPoints& points) {
  const PlanRaster& p = pixels_;
  for (int row = 0; row < p.rows; ++row) {
    Stretch& touched = touched_[std::size_t(row)];
    if (touched.begin < touched.end)
      std::fill(columns_.begin() + std::ptrdiff_t(p.index(touched.begin, row)),
                columns_.begin() + std::ptrdiff_t(p.index(touched.end - 1, row)) + 1, Column{});
    touched = {p.columns, 0};
  }
  volume_outside_ = 0;

  const double per_pixel = 1 / p.pixel;
  std::vector<double> in_columns;  // shares of a point
  for (std::size_t i = 0; i < points.places.size(); ++i) {
    const double volume = points.volumes[i], mass = points.masses[i];
    // A thousandth of a pixel is as good as a point, and its ends differ in their bits.
    const double half = 0.5 * std::max(width_in_plan(volume) * per_pixel, 1e-3);
    const int most = int(std::min(2 * half, 1e6)) + 2;  // pixels
    const double x = (points.places[i][0] - p.corner[0]) * per_pixel,
                 y = (points.places[i][1] - p.corner[1]) * per_pixel;
    const Footprint along_x(x - half, x + half, most, p.columns), along_y(y - half, y + half, most, p.rows);
    if (along_x.is_outside() || along_y.is_outside()) {
      volume_outside_ += volume;
      continue;
    }
    if (x - half < 0 || x + half > p.columns || y - half < 0 || y + half > p.rows)
      volume_outside_ += volume * (1 - along_x.share_inside() * along_y.share_inside());
    const Vec<3>& v = points.velocities[i];
    const Column whole{volume, mass, mass * v[0], mass * v[1], mass * v[2]};
    in_columns.clear();
    for (int c = along_x.first; c <= along_x.last; ++c) in_columns.push_back(along_x.share_of(c));
    for (int row = along_y.first; row <= along_y.last; ++row) {
      const double in_row = along_y.share_of(row);
      Stretch& touched = touched_[std::size_t(row)];
      touched.begin = std::min(touched.begin, along_x.first);
      touched.end = std::max(touched.end, along_x.last + 1);
      Column* column = &columns_[p.index(along_x.first, row)];
      for (const double in_column : in_columns) {
        const double share = in_row * in_column;
        column->volume += share * whole.volume;
        column->mass += share * whole.mass;
        column->momentum_x += share * whole.momentum_x;
        column->momentum_y += share * whole.momentum_y;
        column->momentum_z += share * whole.momentum_z;
        ++column;
      }
    }
  }
}

ColumnFlow FlowColumns::flow_of(std::size_t pixel) const {
  const Column& c = columns_[pixel];
  ColumnFlow flow{};
  flow.vertical_thickness = c.volume / (pixels_.pixel * pixels_.pixel);
  flow.thickness = flow.vertical_thickness * cosines_[pixel];
  flow.is_thick = flow.vertical_thickness > least_thickness_;
  const Vec<3> momentum{c.momentum_x, c.momentum_y, c.momentum_z};
  if (c.mass > 0) flow.velocity = (1 / c.mass) * momentum;
  flow.speed = flow.is_thick ? length(momentum) / c.mass : PlanRaster::none;
  flow.pressure = flow.is_thick ? c.mass / c.volume * flow.speed * flow.speed : PlanRaster::none;
  return flow;
}

void FlowMaps::add(double time, const FlowPoints& points) {
  next_ = std::floor(time / interval_ * (1 + 1e-12)) + 1;
  columns_.gather(points);
  peak_volume_outside_ = std::max(peak_volume_outside_, columns_.volume_outside());
  const auto keep_larger = [](double& peak, double value) {
    if (!(peak >= value)) peak = value;
  };
  for (int row = 0; row < peak_thickness_.rows; ++row)
    for (int column = columns_.touched(row).begin; column < columns_.touched(row).end; ++column) {
      const std::size_t i = peak_thickness_.index(column, row);
      if (!columns_.has_material(i)) continue;
      const ColumnFlow flow = columns_.flow_of(i);
      keep_larger(peak_thickness_.values[i], flow.thickness);
      if (!flow.is_thick) continue;
      keep_larger(peak_speed_.values[i], flow.speed);
      keep_larger(peak_pressure_.values[i], flow.pressure);
      if (std::isnan(arrival_.values[i])) arrival_.values[i] = time;
    }
}

FlowMap FlowMaps::now(const FlowPoints& points) {
  columns_.gather(points);
  const PlanRaster& p = peak_thickness_;
  FlowMap map;
  map.vertical_thickness = map.thickness = PlanRaster::of(p.corner, p.pixel, p.columns, p.rows, 0);
  map.speed = map.pressure = PlanRaster::of(p.corner, p.pixel, p.columns, p.rows);
  map.volume_outside = columns_.volume_outside();
  for (int row = 0; row < p.rows; ++row)
    for (int column = columns_.touched(row).begin; column < columns_.touched(row).end; ++column) {
      const std::size_t i = p.index(column, row);
      const ColumnFlow flow = columns_.flow_of(i);
      map.vertical_thickness.values[i] = flow.vertical_thickness;
      map.thickness.values[i] = flow.thickness;
      map.speed.values[i] = flow.speed;
      map.pressure.values[i] = flow.pressure;
    }
  return map;
}

}  // namespace talus
