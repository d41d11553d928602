#include "talus/output/contour_lines.hpp"

#include <algorithm>
#include <array>
#include <map>

namespace talus {

namespace {

/// The places where connections of neighbouring pixels have a value, by the number of the connection, each with the two
/// that lines lead to from there.
struct Crossing {
  Vec<2> place{};
  std::array<long, 2> next{-1, -1};

  void lead_to(long other) { (next[0] < 0 ? next[0] : next[1]) = other; }
};

/// Finds the crossings of one level, and joins them.
class ContourTracer {
 public:
  ContourTracer(const PlanRaster& raster, double level) : raster_(raster), level_(level) {
    for (int row = 0; row + 1 < raster.rows; ++row)
      for (int column = 0; column + 1 < raster.columns; ++column) add_square(column, row);
  }

  std::vector<PlanLine> lines() {
    std::vector<PlanLine> all;
    for (const auto& [number, crossing] : crossings_)  // open lines from their ends
      if (crossing.next[1] < 0 && !visited_.contains(number)) all.push_back(trace(number));
    for (const auto& [number, crossing] : crossings_)
      if (!visited_.contains(number)) {
        all.push_back(trace(number));
        all.back().push_back(all.back().front());
      }
    return all;
  }

 private:
  bool is_high(int column, int row) const { return raster_.at(column, row) >= level_; }

  /// The number of the connection of a pixel with its neighbour in the east, or in the north.
  long crossing(int column, int row, bool is_north) {
    const long number = 2 * long(raster_.index(column, row)) + (is_north ? 1 : 0);
    const double a = raster_.at(column, row), b = is_north ? raster_.at(column, row + 1) : raster_.at(column + 1, row);
    Vec<2> place = raster_.middle(column, row);
    place[is_north ? 1 : 0] += (level_ - a) / (b - a) * raster_.pixel;
    crossings_[number].place = place;
    return number;
  }
  void join(long a, long b) {
    crossings_[a].lead_to(b);
    crossings_[b].lead_to(a);
  }

  /// Lines in the square between the middles of four pixels, of which this is the one farthest south and west.
  void add_square(int column, int row) {
    double mean = 0;
    for (int i : {0, 1})
      for (int j : {0, 1}) mean += 0.25 * raster_.at(column + i, row + j);
    if (std::isnan(mean)) return;
    const bool sw = is_high(column, row), se = is_high(column + 1, row), nw = is_high(column, row + 1),
               ne = is_high(column + 1, row + 1);
    std::vector<long> around;  // south, east, north, west, as far as they are crossed
    if (sw != se) around.push_back(crossing(column, row, false));
    if (se != ne) around.push_back(crossing(column + 1, row, true));
    if (nw != ne) around.push_back(crossing(column, row + 1, false));
    if (sw != nw) around.push_back(crossing(column, row, true));
    if (around.size() == 2) join(around[0], around[1]);
    if (around.size() < 4) return;
    // A saddle: the corners that are as the middle of the square are connected.
    if (sw == (mean >= level_)) {
      join(around[0], around[1]);
      join(around[2], around[3]);
    } else {
      join(around[3], around[0]);
      join(around[1], around[2]);
    }
  }

  PlanLine trace(long number) {
    PlanLine line;
    while (number >= 0) {
      visited_[number] = true;
      const Crossing& here = crossings_.at(number);
      line.push_back(here.place);
      number = -1;
      for (long next : here.next)
        if (next >= 0 && !visited_.contains(next)) number = next;
    }
    return line;
  }

  const PlanRaster& raster_;
  double level_;
  std::map<long, Crossing> crossings_;
  std::map<long, bool> visited_;
};

}  // namespace

std::vector<PlanLine> contour_lines(const PlanRaster& raster, double level) {
  return ContourTracer(raster, level).lines();
}

std::vector<PlanLine> outlines_of(const PlanRaster& mask) {
  PlanRaster wider = PlanRaster::of({mask.corner[0] - mask.pixel, mask.corner[1] - mask.pixel}, mask.pixel,
                                    mask.columns + 2, mask.rows + 2, 0);
  for (int row = 0; row < mask.rows; ++row)
    for (int column = 0; column < mask.columns; ++column)
      if (mask.at(column, row) > 0) wider.at(column + 1, row + 1) = 1;
  return contour_lines(wider, 0.5);
}

double contour_interval(double low, double high) {
  if (!(high - low > 1e-9 * std::max(std::abs(low), std::abs(high)))) return 0;
  const double least = (high - low) / 25 * (1 - 1e-9);  // and a step to the next is at most 2.5
  const double power = std::pow(10, std::floor(std::log10(least)));
  for (double factor : {1.0, 2.0, 5.0})
    if (factor * power >= least) return factor * power;
  return 10 * power;
}

}  // namespace talus
