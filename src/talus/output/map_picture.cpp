#include "talus/output/map_picture.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <numbers>
#include <tuple>
#include <utility>

#include "talus/base/file.hpp"
#include "talus/base/text.hpp"
#include "talus/output/plot.hpp"

namespace talus {

namespace {

/// 1, 2 or 5 times a power of ten, the largest that is not above `most`.
double round_length(double most) {
  const double power = std::pow(10, std::floor(std::log10(most) + 1e-9));
  for (double factor : {5.0, 2.0})
    if (factor * power <= most * (1 + 1e-9)) return factor * power;
  return power;
}

int decimals_of(double step) { return std::max(0, -int(std::floor(std::log10(step) + 1e-9))); }

/// The name of a projection: what stands first in quotes in its WKT.
std::string title_in_wkt(const std::string& wkt) {
  const std::size_t begin = wkt.find('"'), end = wkt.find('"', begin + 1);
  return end == std::string::npos ? "" : wkt.substr(begin + 1, end - begin - 1);
}

/// A rectangle that grows with what it has to hold.
struct GrowingBox {
  PlanBox box{{1e300, 1e300}, {-1e300, -1e300}};

  void hold(const Vec<2>& x) {
    for (int a : {0, 1}) {
      box.low[a] = std::min(box.low[a], x[a]);
      box.high[a] = std::max(box.high[a], x[a]);
    }
  }
  bool is_empty() const { return !(box.low[0] < box.high[0] && box.low[1] < box.high[1]); }
};

/// Its pixels that are drawn.
bool is_drawn(const MapLayer& layer, double value) {
  return std::isfinite(value) &&
         (!layer.hidden_to || (layer.scale == MapScale::about_zero ? std::abs(value) : value) > *layer.hidden_to);
}

std::vector<PlanLine> release_lines(const MapPicture& picture) {
  std::vector<PlanLine> lines = picture.release;
  for (PlanLine& line : lines)
    if (!line.empty() && !(line.front() == line.back())) line.push_back(line.front());
  if (picture.release_mask)
    for (PlanLine& line : outlines_of(*picture.release_mask)) lines.push_back(std::move(line));
  return lines;
}

/// What is shown: never beyond the terrain, and no narrow strip.
PlanBox part_to_show(const MapPicture& picture, const std::vector<PlanLine>& release) {
  const PlanRaster& heights = picture.ground->heights();
  const PlanBox whole{heights.corner, heights.far_corner()};
  GrowingBox shown;
  double margin = 0.12;
  if (picture.view) {
    shown.box = *picture.view;
    margin = 0;
  } else {
    if (picture.layer) {
      const PlanRaster& v = picture.layer->values;
      const Vec<2> half{0.5 * v.pixel, 0.5 * v.pixel};
      for (int row = 0; row < v.rows; ++row)
        for (int column = 0; column < v.columns; ++column)
          if (is_drawn(*picture.layer, v.at(column, row))) {
            shown.hold(v.middle(column, row) - half);
            shown.hold(v.middle(column, row) + half);
          }
    }
    const bool has_layer = !shown.is_empty();
    if (has_layer || picture.domain)
      for (const PlanLine& line : release)
        for (const Vec<2>& x : line) shown.hold(x);
    if (!has_layer && picture.domain) {
      shown.hold(picture.domain->low);
      shown.hold(picture.domain->high);
    }
  }
  if (shown.is_empty()) return whole;
  PlanBox& box = shown.box;
  const double longest = std::max(box.high[0] - box.low[0], box.high[1] - box.low[1]);
  for (int a : {0, 1}) {
    const double missing = picture.view ? 0 : std::max(0.0, 0.45 * longest - (box.high[a] - box.low[a]));
    box.low[a] = std::max(whole.low[a], box.low[a] - margin * longest - 0.5 * missing);
    box.high[a] = std::min(whole.high[a], box.high[a] + margin * longest + 0.5 * missing);
  }
  return shown.is_empty() ? whole : box;
}

/// A label of a contour line, and its angle [degrees].
struct ContourLabel {
  Vec<2> place;
  double angle;
  double height;
};

/// A picture and where its parts lie [pixels, from the lower left corner].
class MapPage {
 public:
  MapPage(std::filesystem::path folder, std::string name, const MapPicture& picture)
      : folder_(std::move(folder)), name_(std::move(name)), picture_(picture), release_(release_lines(picture)) {
    view_ = part_to_show(picture, release_);
    const double dx = view_.high[0] - view_.low[0], dy = view_.high[1] - view_.low[1];
    tic_step_ = round_length(250 * std::max(dx / 950, dy / most_map_height));
    const int decimals = decimals_of(tic_step_);
    letters_north_ =
        std::max(grouped(map_y(view_.low[1]), decimals).size(), grouped(map_y(view_.high[1]), decimals).size());
    left_ = 72 + 9 * int(letters_north_);
    scale_ = std::min((most_width - left_ - gap - panel_width - right) / dx, most_map_height / dy);
    map_width_ = std::max(200, int(std::lround(scale_ * dx)));
    map_height_ = std::max(120, int(std::lround(scale_ * dy)));
    width_ = left_ + map_width_ + gap + panel_width + right;
    set_height(0);
    if (width_ < least_width) {  // a narrow map stands in the middle of what is left of the legend
      left_ += (least_width - width_) / 2;
      width_ = least_width;
    }
  }

  /// Returns the script.
  std::filesystem::path write() {
    if (picture_.layer) write_layer();
    write_shade();
    mark_lines();
    place_names();
    write_contours();
    set_height(panel_height());
    add_title();
    add_axes();
    write_zones();
    write_outlines();
    write_solids();
    write_thalweg();
    write_gauges();
    write_names();
    add_panel();
    std::filesystem::path script = file(".gp");
    std::string plots;
    for (const std::string& plot : plots_) plots += (plots.empty() ? "plot " : ", \\\n     ") + plot;
    write_whole(script, head() + script_ + plots + "\n");
    return script;
  }

 private:
  static constexpr int gap = 40, panel_width = 260, right = 20, top = 70, bottom = 85, under_panel = 25,
                       least_width = 900;
  static constexpr int most_width = 1400, most_map_height = 1100;
  static constexpr int scale_height = 100;  ///< of the bar of lengths and the arrow to the north

  std::filesystem::path file(const std::string& ending) const { return folder_ / (name_ + ending); }
  std::string quoted(const std::string& ending) const { return gnuplot_text(name_ + ending); }
  double map_x(double x) const { return x + picture_.frame.origin[0]; }
  double map_y(double y) const { return y + picture_.frame.origin[1]; }
  std::string screen(double x, double y) const {
    return fmt::format("screen {:.5f}, screen {:.5f}", x / width_, y / height_);
  }
  void add(const std::string& line) { script_ += line + "\n"; }
  void add_plot(std::string plot) { plots_.push_back(std::move(plot)); }
  void add_text(double x, double y, const std::string& text, const std::string& how = "") {
    add(fmt::format("set label {} at {} {}", gnuplot_text(text), screen(x, y), how));
  }

  /// How gnuplot reads a raster from a binary file.
  std::string binary(const std::string& ending, const char* format, int columns, int rows, const Vec<2>& first,
                     const Vec<2>& pixel, const std::string& use) const {
    return fmt::format(
        "{} binary array=({},{}) format='{}' endian=little origin=({:.10g},{:.10g}) dx={:.10g} dy={:.10g} using {}",
        quoted(ending), columns, rows, format, map_x(first[0]), map_y(first[1]), pixel[0], pixel[1], use);
  }

  /// As high as the map needs with its axis, or the panel beside it.
  void set_height(int panel_height) {
    height_ = top + std::max(map_height_ + bottom, panel_height + under_panel);
    map_top_ = height_ - top;
    panel_foot_ = map_top_ - std::max(map_height_, panel_height);
  }

  std::string head() const {
    return fmt::format("set terminal pngcairo noenhanced rounded size {},{} font 'sans,14' background '#ffffff'\n",
                       width_, height_) +
           "set output " + quoted(".png") + "\nset encoding utf8\nset key off\nset clip two\n";
  }
  void add_title() {
    const double letters = double(picture_.title.size());
    add_text(0.5 * width_, height_ - 34, picture_.title,
             fmt::format("center font ',{:.0f}'", std::clamp(1.35 * width_ / std::max(letters, 1.0), 11.0, 19.0)));
  }

  std::string tics(double low, double high) const {
    std::string all;
    const double step = tic_step_;
    for (double i = std::ceil(low / step - 1e-9); i * step <= high + 1e-9 * step; ++i)
      all += fmt::format("{}'{}' {:.10g}", all.empty() ? "" : ", ", grouped(i * step, decimals_of(step)), i * step);
    return all;
  }

  void add_axes() {
    const double x0 = map_x(view_.low[0]), x1 = map_x(view_.high[0]), y0 = map_y(view_.low[1]),
                 y1 = map_y(view_.high[1]);
    add(fmt::format("set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}", double(left_) / width_,
                    double(left_ + map_width_) / width_));
    add(fmt::format("set tmargin at screen {:.5f}\nset bmargin at screen {:.5f}", double(map_top_) / height_,
                    double(map_top_ - map_height_) / height_));
    add(fmt::format("set xrange [{:.10g}:{:.10g}]\nset yrange [{:.10g}:{:.10g}]", x0, x1, y0, y1));
    add(fmt::format("set xtics ({})\nset ytics ({})", tics(x0, x1), tics(y0, y1)));
    add("set tics out nomirror font ',12' tc '#333333' scale 0.8\nset border 15 lc '#444444' lw 1.2");
    const char* tc = "font ',13' tc '#333333'";
    add_text(left_ + 0.5 * map_width_, map_top_ - map_height_ - 60, "East [m]", fmt::format("center {}", tc));
    add_text(left_ - 44 - 9 * double(letters_north_), map_top_ - 0.5 * map_height_, "North [m]",
             fmt::format("center rotate by 90 {}", tc));
  }

  /// The ground in a light from the north-west at 45 degrees: level ground is grey, what is turned away is covered with
  /// black, what is turned to the light with white, each with its opacity, so that colours drawn below are shaded too.
  void write_shade() {
    const double dx = view_.high[0] - view_.low[0], dy = view_.high[1] - view_.low[1];
    const int columns = std::max(1, int(dx * scale_ / 1.5)), rows = std::max(1, int(dy * scale_ / 1.5));
    const double level = std::sqrt(0.5);
    std::string grey_and_opacity;
    for (int row = 0; row < rows; ++row)
      for (int column = 0; column < columns; ++column) {
        const Vec<2> x{view_.low[0] + (column + 0.5) / columns * dx, view_.low[1] + (row + 0.5) / rows * dy};
        double grey = 1, opacity = 1;  // without ground: white
        if (picture_.ground->is_known(x[0], x[1])) {
          const TerrainPlace g = picture_.ground->at(x[0], x[1]);
          // The normal is (-dx, -dy, 1), the light comes from (-1/2, 1/2, sqrt(1/2)).
          const double lit = (0.5 * g.dx - 0.5 * g.dy + level) / std::sqrt(1 + g.dx * g.dx + g.dy * g.dy);
          grey = lit > level ? 1 : 0;
          // Colours keep their brightness in the light, so that they are those of the scale, and nearly so in the
          // shade.
          if (is_on_layer(x))
            opacity = std::clamp(0.4 * (level - lit), 0.0, 0.3);
          else
            opacity = std::clamp(lit > level ? 2.2 * (lit - level) : 0.55 * (level - lit), 0.0, 0.65);
        } else if (is_on_layer(x)) {
          opacity = 0;
        }
        grey_and_opacity += char(std::lround(255 * grey));
        grey_and_opacity += char(std::lround(255 * opacity));
      }
    write_whole(file("_shade.bin"), grey_and_opacity);
    add("set object rectangle from graph 0, graph 0 to graph 1, graph 1 behind fs solid 1 noborder fc '#cdcdcd'");
    add_plot(binary("_shade.bin", "%uchar%uchar", columns, rows,
                    {view_.low[0] + 0.5 * dx / columns, view_.low[1] + 0.5 * dy / rows}, {dx / columns, dy / rows},
                    "1:1:1:2") +
             " with rgbalpha");
  }

  void write_layer() {
    const MapLayer& layer = *picture_.layer;
    const PlanRaster& v = layer.values;
    // Pixels inside the view only: gnuplot cuts images at odd places.
    int c0 = v.columns, c1 = -1, r0 = v.rows, r1 = -1;
    std::vector<double> drawn;
    for (int row = 0; row < v.rows; ++row)
      for (int column = 0; column < v.columns; ++column) {
        const Vec<2> x = v.middle(column, row);
        if (!is_drawn(layer, v.at(column, row)) || x[0] - 0.5 * v.pixel < view_.low[0] - 1e-6 * v.pixel ||
            x[0] + 0.5 * v.pixel > view_.high[0] + 1e-6 * v.pixel ||
            x[1] - 0.5 * v.pixel < view_.low[1] - 1e-6 * v.pixel ||
            x[1] + 0.5 * v.pixel > view_.high[1] + 1e-6 * v.pixel)
          continue;
        c0 = std::min(c0, column);
        c1 = std::max(c1, column);
        r0 = std::min(r0, row);
        r1 = std::max(r1, row);
        drawn.push_back(layer.scale == MapScale::about_zero ? std::abs(v.at(column, row)) : v.at(column, row));
      }
    if (drawn.empty()) return;
    PlanRaster part =
        PlanRaster::of({v.corner[0] + c0 * v.pixel, v.corner[1] + r0 * v.pixel}, v.pixel, c1 - c0 + 1, r1 - r0 + 1);
    std::string numbers;
    for (int row = r0; row <= r1; ++row)
      for (int column = c0; column <= c1; ++column) {
        const double value = v.at(column, row);
        const float number = float(is_drawn(layer, value) ? value : PlanRaster::none);
        numbers.append(reinterpret_cast<const char*>(&number), sizeof number);
      }
    write_whole(file("_layer.bin"), numbers);
    std::sort(drawn.begin(), drawn.end());
    largest_ = drawn.back();
    // Up to the 99.5th percentile, so that a few pixels do not leave all others in the lowest colours.
    const double end = drawn[std::size_t(0.995 * double(drawn.size() - 1))];
    const double begin = layer.hidden_to ? *layer.hidden_to : drawn.front();
    scale_end_ = end > begin ? end : begin + 1;
    if (layer.scale == MapScale::about_zero) {
      add("set palette defined (-3 '#053061', -2 '#2166ac', -1 '#74add1', 0 '#f7f7f7', 1 '#f4a582', 2 '#b2182b', 3 "
          "'#67001f')");
      add(fmt::format("set cbrange [{:.4g}:{:.4g}]", -*scale_end_, *scale_end_));
    } else {
      add("set palette defined (0 '#f0f921', 1 '#fdb42f', 2 '#ed7953', 3 '#cc4778', 4 '#9c179e', 5 '#5c01a6', 6 "
          "'#0d0887')");
      add(fmt::format("set cbrange [{:.4g}:{:.4g}]", begin, *scale_end_));
    }
    if (layer.scale == MapScale::logarithmic && end > 0) {
      // Down to a round power of ten; what is lower has the lowest colour.
      const double low = std::pow(10, std::floor(std::log10(std::max(end / 1000, drawn.front())) + 1e-9));
      add("set logscale cb");
      add(fmt::format("set cbrange [{:.4g}:{:.4g}]", low, end > low ? end : 10 * low));
    }
    add_plot(fmt::format("{} with image", binary("_layer.bin", "%float32", part.columns, part.rows, part.middle(0, 0),
                                                 {part.pixel, part.pixel}, "1")));
  }

  /// Heights on a raster that is coarse enough for smooth lines, three pixels of the picture or the terrain's own.
  PlanRaster heights() const {
    const double pixel = std::max(3 / scale_, std::min(8 / scale_, picture_.ground->heights().pixel));
    PlanRaster z = PlanRaster::of({view_.low[0] - 0.5 * pixel, view_.low[1] - 0.5 * pixel}, pixel,
                                  int((view_.high[0] - view_.low[0]) / pixel) + 2,
                                  int((view_.high[1] - view_.low[1]) / pixel) + 2);
    for (int row = 0; row < z.rows; ++row)
      for (int column = 0; column < z.columns; ++column) {
        const Vec<2> x = z.middle(column, row);
        if (picture_.ground->is_known(x[0], x[1])) z.at(column, row) = picture_.ground->at(x[0], x[1]).height;
      }
    return z;
  }

  bool is_on_layer(const Vec<2>& x) const {
    if (!picture_.layer) return false;
    const PlanRaster& v = picture_.layer->values;
    const int column = v.column_of(x[0]), row = v.row_of(x[1]);
    return v.has_pixel(column, row) && is_drawn(*picture_.layer, v.at(column, row));
  }

  /// Whether a place is close to a line along which the domain ends.
  bool is_on_domain(const Vec<2>& x, double distance) const {
    if (!picture_.domain) return false;
    for (int a : {0, 1})
      if (std::abs(x[a] - picture_.domain->low[a]) < distance || std::abs(x[a] - picture_.domain->high[a]) < distance)
        return true;
    return false;
  }

  /// Where on a line its labels stand: where it is straight, away from others, from the frame and from colours; each
  /// covers the points from `first` to `last`.
  struct Gap {
    std::size_t first, last;
  };
  std::vector<Gap> place_labels(const PlanLine& line, double height) {
    const double label = (8 * double(grouped(height, decimals_of(interval_)).size()) + 16) / scale_;
    std::vector<double> along{0};
    for (std::size_t i = 1; i < line.size(); ++i) along.push_back(along.back() + length(line[i] - line[i - 1]));
    struct Candidate {
      double straightness;
      Gap gap;
    };
    std::vector<Candidate> candidates;
    std::size_t j = 0;
    for (std::size_t i = 0; i < line.size(); ++i) {
      while (j < line.size() && along[j] - along[i] < label) ++j;
      if (j == line.size()) break;
      const Vec<2> middle = 0.5 * (line[i] + line[j]);
      const double border = 0.6 * label;
      if (middle[0] - border < view_.low[0] || middle[0] + border > view_.high[0] ||
          middle[1] - border < view_.low[1] || middle[1] + border > view_.high[1] || is_on_layer(middle) ||
          is_on_layer(line[i]) || is_on_layer(line[j]) || is_on_domain(middle, border) || is_on_name(middle, border) ||
          marks_in({middle - Vec<2>{border, border}, middle + Vec<2>{border, border}}) > 0)
        continue;
      double farthest = 0;  // of the points between from the chord
      const Vec<2> chord = line[j] - line[i];
      for (std::size_t k = i; k <= j; ++k) {
        const Vec<2> d = line[k] - line[i];
        farthest = std::max(farthest, std::abs(chord[0] * d[1] - chord[1] * d[0]) / length(chord));
      }
      if (farthest * scale_ < 6) candidates.push_back({-farthest, {i, j}});
    }
    std::stable_sort(candidates.begin(), candidates.end(),
                     [](const Candidate& a, const Candidate& b) { return a.straightness > b.straightness; });
    std::vector<Gap> gaps;
    for (const Candidate& c : candidates) {
      const Vec<2> a = line[c.gap.first], b = line[c.gap.last], middle = 0.5 * (a + b);
      const bool is_free = std::none_of(labels_.begin(), labels_.end(), [&](const ContourLabel& other) {
        const double distance = length(other.place - middle) * scale_;
        return distance < (other.height == height ? 350 : 80);
      });
      if (!is_free) continue;
      double angle = std::atan2(b[1] - a[1], b[0] - a[0]) * 180 / std::numbers::pi;
      // From bottom to top on all lines that are nearly vertical, whichever way they lean.
      if (angle > 100) angle -= 180;
      if (angle <= -80) angle += 180;
      labels_.push_back({middle, angle, height});
      gaps.push_back(c.gap);
    }
    std::sort(gaps.begin(), gaps.end(), [](const Gap& a, const Gap& b) { return a.first < b.first; });
    return gaps;
  }

  void append_line(std::string& text, const PlanLine& line, std::size_t first, std::size_t last) const {
    for (std::size_t i = first; i <= last && i < line.size(); ++i)
      text += fmt::format("{:.10g} {:.10g}\n", map_x(line[i][0]), map_y(line[i][1]));
    text += "\n";
  }

  void write_contours() {
    const PlanRaster z = heights();
    double low = 1e300, high = -1e300;
    for (double v : z.values)
      if (!std::isnan(v)) {
        low = std::min(low, v);
        high = std::max(high, v);
      }
    interval_ = contour_interval(low, high);
    if (!(interval_ > 0)) return;
    // Every fifth line, or fourth where the interval begins with a 5, is thicker and has its height: 20 gives 100, 50
    // gives 200.
    const double digit = interval_ / std::pow(10, std::floor(std::log10(interval_) + 1e-9));
    const int every = digit > 4 ? 4 : 5;
    const std::string head = "# lines of equal height: east [m], north [m]\n";
    std::string thin = head, thick = head;
    for (double i = std::ceil(low / interval_); i * interval_ <= high; ++i) {
      const double level = i * interval_;
      const bool is_thick = std::fmod(std::abs(i), every) < 0.5;
      // A little lower, so that flat ground at a round height, a lake, has an edge and no pattern of rounding errors.
      for (const PlanLine& line : contour_lines(z, level - 2e-3 * interval_)) {
        double around = 0;
        for (std::size_t k = 1; k < line.size(); ++k) around += length(line[k] - line[k - 1]);
        if (around * scale_ < 40) continue;  // a boulder
        if (!is_thick) {
          append_line(thin, line, 0, line.size() - 1);
          continue;
        }
        std::size_t first = 0;
        for (const Gap& space : place_labels(line, level)) {
          if (space.first > first) append_line(thick, line, first, space.first);
          first = space.last;
        }
        append_line(thick, line, first, line.size() - 1);
      }
    }
    std::string labels = "# east [m], north [m], height, angle [degrees]\n";
    for (const ContourLabel& l : labels_)
      labels += fmt::format("{:.10g} {:.10g} \"{}\" {:.1f}\n", map_x(l.place[0]), map_y(l.place[1]),
                            grouped(l.height, decimals_of(interval_)), l.angle);
    for (const auto& [text, ending, width] :
         {std::tuple(thin, "_contours.txt", 0.8), std::tuple(thick, "_index_contours.txt", 1.7)}) {
      if (text == head) continue;
      write_whole(file(ending), text);
      add_plot(fmt::format("{} with lines lw {:g} lc '{}'", quoted(ending), width, contour_colour));
    }
    if (labels_.empty()) return;
    write_whole(file("_heights.txt"), labels);
    add_plot(
        fmt::format("{} using 1:2:3:4 with labels rotate variable font ',11' tc '#3d2f22'", quoted("_heights.txt")));
  }

  void write_outlines() {
    if (!release_.empty()) {
      std::string text = "# outline of the release: east [m], north [m]\n";
      for (const PlanLine& line : release_) append_line(text, line, 0, line.size() - 1);
      write_whole(file("_release.txt"), text);
      add_plot(fmt::format("{} with lines lw 5 lc '#ffffff'", quoted("_release.txt")));
      add_plot(fmt::format("{} with lines lw 2.5 lc '{}'", quoted("_release.txt"), release_colour));
    }
    if (picture_.domain) {
      const PlanBox& d = *picture_.domain;
      std::string text = "# outline of the domain: east [m], north [m]\n";
      append_line(text, {d.low, {d.high[0], d.low[1]}, d.high, {d.low[0], d.high[1]}, d.low}, 0, 4);
      write_whole(file("_domain.txt"), text);
      add_plot(fmt::format("{} with lines lw 2 dt (12,11) lc '{}'", quoted("_domain.txt"), domain_colour));
    }
  }

  bool is_in_view(const Vec<2>& x) const {
    return x[0] >= view_.low[0] && x[0] <= view_.high[0] && x[1] >= view_.low[1] && x[1] <= view_.high[1];
  }

  /// The name of a gauge or solid, and the rectangle that it covers.
  struct PlacedName {
    std::string text;
    const char* colour;
    PlanBox box;
  };
  /// What has a name that stands beside it, at one of several places.
  struct Named {
    std::string text;
    const char* colour;
    std::vector<PlanBox> places;
  };
  std::vector<Named> named() const {
    std::vector<Named> all;
    for (const MapGauge& gauge : picture_.gauges)
      all.push_back({gauge.name,
                     gauge_colour,
                     {{gauge.points.back(), gauge.points.back()}, {gauge.points.front(), gauge.points.front()}}});
    for (const MapArea& solid : picture_.solids) {
      GrowingBox around;
      for (const PlanLine& line : solid.outlines)
        for (const Vec<2>& x : line) around.hold(x);
      if (!around.is_empty()) all.push_back({solid.name, solid_colour, {around.box}});
    }
    return all;
  }
  static bool overlap(const PlanBox& a, const PlanBox& b) {
    return a.low[0] < b.high[0] && b.low[0] < a.high[0] && a.low[1] < b.high[1] && b.low[1] < a.high[1];
  }
  bool is_on_name(const Vec<2>& x, double distance) const {
    const Vec<2> around{distance, distance};
    return std::any_of(names_.begin(), names_.end(), [&](const PlacedName& n) {
      return overlap(n.box, {x - around, x + around});
    });
  }

  /// Marks the squares of a few pixels through which outlines and lines pass, for names and heights to stand beside.
  void mark_lines() {
    const double edge = 5 / scale_;
    marks_ = PlanRaster::of(view_.low, edge, int((view_.high[0] - view_.low[0]) / edge) + 1,
                            int((view_.high[1] - view_.low[1]) / edge) + 1, 0);
    const auto mark = [&](const PlanLine& line) {
      for (std::size_t i = 0; i + 1 < line.size(); ++i) {
        const Vec<2> way = line[i + 1] - line[i];
        const int n = 1 + int(std::min(length(way) / edge, 1e6));
        for (int k = 0; k <= n; ++k) {
          const Vec<2> x = line[i] + (double(k) / n) * way;
          if (is_in_view(x)) marks_.at(marks_.column_of(x[0]), marks_.row_of(x[1])) = 1;
        }
      }
    };
    for (const PlanLine& line : release_) mark(line);
    for (const auto* areas : {&picture_.zones, &picture_.solids})
      for (const MapArea& area : *areas)
        for (const PlanLine& line : area.outlines) mark(line);
    for (const MapGauge& gauge : picture_.gauges) mark(gauge.points);
    mark(picture_.thalweg);
  }
  /// The number of marked squares in a box.
  int marks_in(const PlanBox& box) const {
    int n = 0;
    for (int row = std::max(0, marks_.row_of(box.low[1])); row <= std::min(marks_.rows - 1, marks_.row_of(box.high[1]));
         ++row)
      for (int column = std::max(0, marks_.column_of(box.low[0]));
           column <= std::min(marks_.columns - 1, marks_.column_of(box.high[0])); ++column)
        n += marks_.at(column, row) > 0;
    return n;
  }

  /// Names stand beside a place, an end of a line, or a solid: of the places inside the map at the one that covers the
  /// fewest of other names and gauges, then of lines.
  void place_names() {
    std::vector<PlanBox> taken;
    const Vec<2> symbol{9 / scale_, 9 / scale_};
    for (const MapGauge& gauge : picture_.gauges)
      for (const Vec<2>& x : gauge.points) taken.push_back({x - symbol, x + symbol});
    for (const Named& it : named()) {
      const Vec<2> half{(4.4 * double(it.text.size()) + 6) / scale_, 12 / scale_};
      std::optional<PlanBox> best;
      std::pair<long, int> least;
      for (const PlanBox& place : it.places) {
        const Vec<2> x = 0.5 * (place.low + place.high), extent = 0.5 * (place.high - place.low);
        const double aside = extent[0] + half[0] + 13 / scale_, up = extent[1] + half[1] + 12 / scale_;
        for (const Vec<2>& way : {Vec<2>{aside, 0}, Vec<2>{-aside, 0}, Vec<2>{0, -up}, Vec<2>{0, up},
                                  Vec<2>{aside, -up}, Vec<2>{-aside, -up}, Vec<2>{aside, up}, Vec<2>{-aside, up}}) {
          const PlanBox box{x + way - half, x + way + half};
          if (!is_in_view(x) || !is_in_view(box.low) || !is_in_view(box.high)) continue;
          const std::pair covered(
              std::count_if(taken.begin(), taken.end(), [&](const PlanBox& t) { return overlap(t, box); }),
              marks_in(box));
          if (best && !(covered < least)) continue;
          best = box;
          least = covered;
        }
      }
      if (!best) continue;
      names_.push_back({it.text, it.colour, *best});
      taken.push_back(names_.back().box);
    }
  }

  /// Draws the outlines of areas: in white, then `inner` on it.
  void write_areas(const std::vector<MapArea>& areas, const std::string& ending, const std::string& what,
                   double white_width, const std::string& inner) {
    std::string text = fmt::format("# outlines of {}: east [m], north [m]\n", what);
    bool any = false;
    for (const MapArea& area : areas)
      for (const PlanLine& line : area.outlines) {
        append_line(text, line, 0, line.size() - 1);
        any = true;
      }
    if (!any) return;
    write_whole(file(ending), text);
    add_plot(fmt::format("{} with lines lw {} lc '#ffffff'", quoted(ending), white_width));
    add_plot(quoted(ending) + " with lines " + inner);
  }
  void write_zones() {
    write_areas(picture_.zones, "_zones.txt", "zones", 3.6, fmt::format("lw 1.8 dt (5,8) lc '{}'", zone_colour));
  }
  void write_solids() {
    write_areas(picture_.solids, "_solids.txt", "solids above the ground", 4.5,
                fmt::format("lw 2.2 lc '{}'", solid_colour));
  }

  void write_thalweg() {
    if (picture_.thalweg.size() < 2) return;
    std::string text = "# thalweg: east [m], north [m]\n";
    append_line(text, picture_.thalweg, 0, picture_.thalweg.size() - 1);
    write_whole(file("_thalweg.txt"), text);
    add_plot(fmt::format("{} with lines lw 4.5 lc '#ffffff'", quoted("_thalweg.txt")));
    add_plot(fmt::format("{} with lines lw 2.2 dt (14,9) lc '{}'", quoted("_thalweg.txt"), thalweg_colour));
    // An arrow at the lower end, as long as its head.
    const Vec<2> end = picture_.thalweg.back();
    Vec<2> before = picture_.thalweg[picture_.thalweg.size() - 2];
    const double last = length(end - before);
    if (!(last > 0) || !is_in_view(end)) return;
    before = end + (std::min(1.0, 16 / scale_ / last)) * (before - end);
    add(fmt::format(
        "set arrow from {:.10g},{:.10g} to {:.10g},{:.10g} head filled size screen 0.012,20 front lw 2.2 lc '{}'",
        map_x(before[0]), map_y(before[1]), map_x(end[0]), map_y(end[1]), thalweg_colour));
  }

  void write_gauges() {
    const std::string head = "# gauges: east [m], north [m]\n";
    std::string lines = head, places = head;
    for (const MapGauge& gauge : picture_.gauges)
      append_line(gauge.points.size() > 1 ? lines : places, gauge.points, 0, gauge.points.size() - 1);
    if (lines != head) {
      write_whole(file("_gauge_lines.txt"), lines);
      add_plot(fmt::format("{} with lines lw 5.5 lc '#ffffff'", quoted("_gauge_lines.txt")));
      add_plot(fmt::format("{} with lines lw 3 lc '{}'", quoted("_gauge_lines.txt"), gauge_colour));
    }
    if (places != head) {
      write_whole(file("_gauge_places.txt"), places);
      add_plot(fmt::format("{} with points pt 9 ps 2.6 lc '#ffffff'", quoted("_gauge_places.txt")));
      add_plot(fmt::format("{} with points pt 9 ps 1.7 lc '{}'", quoted("_gauge_places.txt"), gauge_colour));
    }
  }

  void write_names() {
    if (!names_.empty()) add("set style textbox opaque fillcolor '#ffffff' noborder margins 0.7,0.6");
    for (const auto& [ending, colour] : {std::pair("_gauges.txt", gauge_colour), {"_solid_names.txt", solid_colour}}) {
      const std::string head = "# east [m], north [m], name\n";
      std::string text = head;
      for (const PlacedName& name : names_)
        if (name.colour == colour) {
          const Vec<2> middle = 0.5 * (name.box.low + name.box.high);
          text += fmt::format("{:.10g} {:.10g} \"{}\"\n", map_x(middle[0]), map_y(middle[1]), name.text);
        }
      if (text == head) continue;
      write_whole(file(ending), text);
      add_plot(fmt::format("{} using 1:2:3 with labels boxed font ',12' tc '{}'", quoted(ending), colour));
    }
  }

  /// Whether a part of a line is in the view.
  bool is_seen(const PlanLine& line) const {
    for (std::size_t i = 0; i < line.size(); ++i) {
      const Vec<2> from = line[i], way = line[std::min(i + 1, line.size() - 1)] - from;
      const int n = 1 + int(length(way) * scale_ / 10);
      for (int k = 0; k <= n; ++k)
        if (is_in_view(from + (double(k) / n) * way)) return true;
    }
    return false;
  }

  void add_line(double x0, double y0, double x1, double y1, const std::string& how) {
    add(fmt::format("set arrow from {} to {} nohead {}", screen(x0, y0), screen(x1, y1), how));
  }
  void add_rectangle(double x0, double y0, double x1, double y1, const char* colour) {
    add(fmt::format("set object rectangle from {} to {} fs solid 1 border lc '#222222' fc '{}' lw 1", screen(x0, y0),
                    screen(x1, y1), colour));
  }

  double panel_x() const { return left_ + map_width_ + gap; }

  /// Beside the map, from the top: colours, legend, notes. Returns where they end.
  double add_words() {
    const double x = panel_x();
    double y = map_top_ - 10;
    if (picture_.layer) y = add_colours(x, y);
    y = add_legend(x, y);
    for (const std::string& note : notes())
      for (const std::string& line : broken_at_blanks(note, 30)) {
        add_text(x, y, line, "font ',12' tc '#333333'");
        y -= 23;
      }
    return y;
  }
  /// The height that all of it needs.
  int panel_height() {
    const std::string so_far = script_;
    const int height = int(map_top_ - add_words()) + scale_height;
    script_ = so_far;
    return height;
  }
  void add_panel() {
    add_words();
    add_scale_and_north(panel_x());
  }

  double add_colours(double x, double y) {
    const MapLayer& layer = *picture_.layer;
    for (const std::string& line :
         broken_at_blanks(layer.words + (layer.unit.empty() ? "" : " [" + layer.unit + "]"), 26)) {
      add_text(x, y, line);
      y -= 26;
    }
    if (!scale_end_) {
      add_text(x, y, "none", "tc '#333333'");
      return y - 40;
    }
    const double bar = std::clamp(0.3 * map_height_, 180.0, 300.0);
    add(fmt::format("set colorbox user origin {} size screen {:.5f}, screen {:.5f}", screen(x, y - bar), 24.0 / width_,
                    bar / height_));
    add("set cbtics font ',12' tc '#333333' scale 0.6");
    y -= bar + 26;
    add_text(x, y,
             fmt::format("largest{}: {} {}", layer.scale == MapScale::about_zero ? " either way" : "",
                         three_digits(*largest_), layer.unit),
             "font ',12' tc '#333333'");
    return y - 44;
  }

  /// Whether some of the edge of a rectangle is in the view.
  bool is_seen(const PlanBox& box) const {
    bool overlaps = true, surrounds = true;
    for (int a : {0, 1}) {
      overlaps = overlaps && box.low[a] <= view_.high[a] && box.high[a] >= view_.low[a];
      surrounds = surrounds && box.low[a] < view_.low[a] && box.high[a] > view_.high[a];
    }
    return overlaps && !surrounds;
  }

  double add_legend(double x, double y) {
    const double swatch = 42, row = 30;
    const auto entry = [&](const std::string& text, const std::string& line) {
      add_line(x, y, x + swatch, y, line);
      add_text(x + swatch + 12, y, text, "font ',12'");
      y -= row;
    };
    if (!release_.empty()) entry("Release", fmt::format("lw 2.5 lc '{}'", release_colour));
    if (picture_.domain && is_seen(*picture_.domain))
      entry("Domain", fmt::format("lw 2 dt (8,9) lc '{}'", domain_colour));
    // One line of the legend for each zone, as long as there are few.
    constexpr std::size_t most_zones = 4;
    const std::string dashes = fmt::format("lw 1.8 dt (5,8) lc '{}'", zone_colour);
    std::vector<std::string> zones;
    const auto is_area_seen = [&](const MapArea& area) {
      return std::any_of(area.outlines.begin(), area.outlines.end(), [&](const PlanLine& l) { return is_seen(l); });
    };
    for (const MapArea& zone : picture_.zones)
      if (is_area_seen(zone)) zones.push_back(zone.name);
    if (zones.size() > most_zones) zones = {fmt::format("{} zones", zones.size())};
    for (const std::string& name : zones) entry(name, dashes);
    if (std::any_of(picture_.solids.begin(), picture_.solids.end(), is_area_seen))
      entry("Solid", fmt::format("lw 2.2 lc '{}'", solid_colour));
    if (is_seen(picture_.thalweg))
      entry(picture_.thalweg_width > 0 ? fmt::format("Thalweg, strip of {} m", three_digits(picture_.thalweg_width))
                                       : std::string("Thalweg"),
            fmt::format("lw 2.2 dt (12,9) lc '{}'", thalweg_colour));
    bool lines = false, places = false;
    for (const MapGauge& gauge : picture_.gauges)
      if (is_seen(gauge.points)) (gauge.points.size() > 1 ? lines : places) = true;
    if (lines) entry("Gauge, line", fmt::format("lw 3 lc '{}'", gauge_colour));
    if (places) {
      add_text(x + 0.5 * swatch, y, "", fmt::format("point pt 9 ps 1.7 lc '{}'", gauge_colour));
      add_text(x + swatch + 12, y, "Gauge, place", "font ',12'");
      y -= row;
    }
    if (interval_ > 0)
      entry(fmt::format("Contours every {:g} m", interval_), fmt::format("lw 1.2 lc '{}'", contour_colour));
    if (picture_.cell > 0) y = add_cells(x, y);
    return y - 8;
  }

  /// A square of cells in the scale of the map, if they can be seen.
  double add_cells(double x, double y) {
    const double cell = picture_.cell * scale_;
    int n = 0;
    for (int k : {10, 5, 4, 3, 2, 1})
      if (n == 0 && k * cell <= 42) n = k;
    if (n == 0 || cell < 3.5) {
      add_text(x, y, fmt::format("Cells of {:g} m", picture_.cell), "font ',12'");
      return y - 30;
    }
    const double edge = n * cell, up = y + 12;
    for (int k = 0; k <= n; ++k) {
      add_line(x + k * cell, up, x + k * cell, up - edge, "lw 1 lc '#333333'");
      add_line(x, up - k * cell, x + edge, up - k * cell, "lw 1 lc '#333333'");
    }
    add_text(x + 54, std::min(y, up - 0.5 * edge), fmt::format("Cells of {:g} m, to scale", picture_.cell),
             "font ',12'");
    return y - std::max(30.0, edge + 8);
  }

  std::vector<std::string> notes() const {
    std::vector<std::string> all = picture_.notes;
    const std::string projection = title_in_wkt(picture_.frame.projection);
    if (!projection.empty()) all.push_back(projection);
    return all;
  }

  /// At the foot of the panel.
  void add_scale_and_north(double x) {
    const double y = panel_foot_ + 14, metres = round_length(170 / scale_), bar = metres * scale_;
    add_rectangle(x, y, x + 0.5 * bar, y + 9, "#222222");
    add_rectangle(x + 0.5 * bar, y, x + bar, y + 9, "#ffffff");
    const bool is_long = metres >= 1000;
    add_text(x, y + 26, "0", "center font ',12'");
    add_text(x + bar, y + 26, fmt::format("{:g} {}", is_long ? metres / 1000 : metres, is_long ? "km" : "m"),
             "center font ',12'");
    // North arrow
    const double nx = x + panel_width - 25, ny = y;
    add(fmt::format("set object polygon from {} to {} to {} to {} fs solid 1 noborder fc '#222222'",
                    screen(nx, ny + 46), screen(nx - 13, ny), screen(nx, ny + 10), screen(nx, ny + 46)));
    add(fmt::format("set object polygon from {} to {} to {} to {} fs empty border lc '#222222' lw 1.2",
                    screen(nx, ny + 46), screen(nx + 13, ny), screen(nx, ny + 10), screen(nx, ny + 46)));
    add_text(nx, ny + 62, "N", "center");
  }

  static constexpr const char *contour_colour = "#8a745f", *release_colour = "#d01c1c", *domain_colour = "#111111",
                              *thalweg_colour = "#00509e", *gauge_colour = "#00509e", *zone_colour = "#1b6e3c",
                              *solid_colour = "#1a1a1a";

  std::filesystem::path folder_;
  std::string name_;
  const MapPicture& picture_;
  std::vector<PlanLine> release_;
  PlanBox view_;
  double scale_ = 1;  ///< [pixels/m]
  int map_width_ = 0, map_height_ = 0, width_ = 0, height_ = 0, map_top_ = 0, left_ = 0, panel_foot_ = 0;
  double tic_step_ = 1;            ///< [m]
  std::size_t letters_north_ = 0;  ///< of the longest number along the axis
  double interval_ = 0;            ///< of contours [m]
  std::optional<double> scale_end_, largest_;
  std::vector<ContourLabel> labels_;
  PlanRaster marks_;  ///< see mark_lines
  std::vector<PlacedName> names_;
  std::string script_;
  std::vector<std::string> plots_;
};

}  // namespace

std::string grouped(double value, int decimals) {
  std::string digits = fmt::format("{:.{}f}", std::abs(value), decimals);
  const std::size_t point = std::min(digits.find('.'), digits.size());
  for (std::size_t i = point; i > 3; i -= 3) digits.insert(i - 3, " ");
  const bool is_zero = digits.find_first_not_of("0. ") == std::string::npos;
  return (value < 0 && !is_zero ? "-" : "") + digits;
}

std::string three_digits(double value) { return std::abs(value) < 100 ? fmt::format("{:.3g}", value) : grouped(value); }

std::filesystem::path write_map_script(const std::filesystem::path& folder, const std::string& name,
                                       const MapPicture& picture) {
  assert(picture.ground);
  return MapPage(folder, name, picture).write();
}

bool draw_map(const std::filesystem::path& png, const MapPicture& picture) {
  const std::string name = png.stem().string();
  const DrawingFolder folder(png);
  if (!run_gnuplot(write_map_script(folder.path(), name, picture))) return false;
  std::filesystem::rename(folder.path() / (name + ".png"), png);
  return true;
}

}  // namespace talus
