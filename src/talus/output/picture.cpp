#include "talus/output/picture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <future>
#include <map>
#include <sstream>

#include "talus/base/file.hpp"
#include "talus/base/table.hpp"
#include "talus/base/text.hpp"
#include "talus/output/plot.hpp"

namespace talus {

/// A quantity that pictures show if a law of the case has it.
struct PictureBook::Quantity {
  std::string name, title, label;
};

/// All instants, read back: their extent and, for the scales, the values of each quantity.
struct PictureBook::Instants {
  std::vector<std::string> names;  ///< of the columns
  std::map<std::string, std::vector<double>> values;
  double low[2], high[2];  ///< [m]
};

/// Panels with room for tics, titles and the colour bar [pixels]. Heights have the scale of lengths, except in what is
/// very flat or very tall.
struct PictureBook::Layout {
  int n, columns, rows, panel_width, panel_height, n_title_lines = 1;
  double stretch;  ///< scale of heights over that of lengths
  static constexpr int least_bar_height = 220, gap_x = 70, gap_y = 64, left = 80, right = 140, bottom = 60,
                       title_line = 24, letter = 10;

  Layout(int panels, double extent_x, double extent_y)
      : n(panels), columns(n > 1 ? 2 : 1), rows((n + columns - 1) / columns) {
    constexpr double widest = 560, narrowest = 160, tallest = 700, lowest = 60;
    const double slenderness = extent_y / extent_x;
    panel_width = int(std::clamp(tallest / slenderness, narrowest, widest));
    panel_height = int(std::clamp(panel_width * slenderness, lowest, tallest));
    const double ratio = panel_height / (panel_width * slenderness);
    stretch = std::abs(ratio - 1) < 0.02 ? 1 : ratio;
  }
  int width() const { return left + columns * panel_width + (columns - 1) * gap_x + right; }
  int top() const { return 46 + n_title_lines * title_line; }
  int panels_height() const { return rows * panel_height + (rows - 1) * gap_y; }
  int bar_height() const { return std::max(panels_height(), least_bar_height); }
  int height() const { return top() + bar_height() + bottom; }
  /// Upper end of a row of panels, from below.
  int end_of_row(int row) const {
    return height() - top() - (bar_height() - panels_height()) / 2 - row * (panel_height + gap_y);
  }
  std::size_t letters_a_line() const { return std::size_t(width() / letter); }
};

const std::vector<PictureBook::Quantity> PictureBook::quantities = {
    {"speed", "Speed", "speed [m/s]"},
    {"kappa", "Equivalent plastic strain", "plastic strain [-]"},
    {"viscosity", "Equivalent shear viscosity", "viscosity 2 f_{/Symbol F} {/Symbol m}|g| [Pa s]"}};

PictureBook::PictureBook(std::filesystem::path folder, const Case& case_, std::vector<double> times)
    : folder_(std::move(folder)),
      dim_(case_.dim),
      axisymmetric_(case_.axisymmetric),
      cell_(case_.cell),
      unit_(length_unit_for(extent(case_))),
      title_(case_.title),
      solids_(case_.solids),
      times_(std::move(times)) {
  const Box box = bounding_box(case_.bodies.at(0).region, dim_);
  slice_ = 0.5 * (box.min[1] + box.max[1]);
  floor_ = case_.domain.min[dim_ - 1];
  std::filesystem::create_directories(folder_);
}

std::filesystem::path PictureBook::instant(int number) const { return folder_ / fmt::format("instant_{}.csv", number); }

void PictureBook::add(const Observation& seen) {
  const Field &x = seen.fields.at(0), &v = *seen.find("velocity"), &volume = *seen.find("volume");
  std::ostringstream out;
  out << "# t = " << seen.time << " s\n" << (dim_ == 3 ? "x [m],z [m]" : "x [m],y [m]") << ",size [m],speed [m/s]";
  std::vector<const Field*> fields;
  for (const Quantity& q : quantities)
    if (const Field* f = seen.find(q.name)) {
      fields.push_back(f);
      out << "," << f->name << " [" << f->unit << "]";
    }
  out << "\n";
  const int up = dim_ - 1;
  for (int i = 0; i < seen.n_particles(); ++i) {
    if (dim_ == 3 && std::abs(x.values[3 * i + 1] - slice_) > 0.5 * cell_) continue;
    const double size = size_of_particle(volume.values[i], axisymmetric_ ? x.values[3 * i] : 1, dim_);
    out << fmt::format("{:.6g},{:.6g},{:.3g},{:.4g}", x.values[3 * i], x.values[3 * i + up], std::min(size, cell_),
                       std::hypot(v.values[3 * i], v.values[3 * i + 1], v.values[3 * i + 2]));
    for (const Field* f : fields) out << fmt::format(",{:.4g}", f->values[i]);
    out << "\n";
  }
  write_whole(instant(int(times_.size())), out.str());
  times_.push_back(seen.time);
}

std::vector<std::string> PictureBook::fields() {
  std::vector<std::string> names{"velocity", "volume"};
  for (const Quantity& q : quantities) names.push_back(q.name);
  return names;
}

std::string PictureBook::write_solids(int number, const double low[2], const double high[2], double spacing) const {
  const int up = dim_ - 1;
  Box shown{{low[0], 0, 0}, {high[0], 0, 0}};
  if (dim_ == 3) shown.min[1] = shown.max[1] = slice_;
  shown.min[up] = low[1];
  shown.max[up] = high[1];
  std::string rows = dim_ == 3 ? "x [m],z [m]\n" : "x [m],y [m]\n";
  for (const Solid& solid : solids_)
    for (const Vec<3>& x : surface_points(solid, solid.motion.at(times_[number]), shown, spacing, dim_))
      rows += fmt::format("{:.6g},{:.6g}\n", x[0], x[up]);
  std::string name = fmt::format("solids_{}.csv", number);
  write_whole(folder_ / name, rows);
  return name;
}

PictureBook::Instants PictureBook::read_instants() const {
  Instants all{{}, {}, {1e300, 1e300}, {-1e300, -1e300}};
  for (std::size_t i = 0; i < times_.size(); ++i) {
    const NumberTable table = read_csv(instant(int(i)).string());
    all.names = table.names;
    for (const auto& row : table.rows) {
      for (int a = 0; a < 2; ++a) {
        all.low[a] = std::min(all.low[a], row[a]);
        all.high[a] = std::max(all.high[a], row[a]);
      }
      for (std::size_t c = 3; c < row.size(); ++c)
        if (std::isfinite(row[c])) all.values[all.names[c].substr(0, all.names[c].find(' '))].push_back(row[c]);
    }
  }
  return all;
}

std::string PictureBook::caption(const Quantity& quantity) const {
  return quantity.title + (dim_ == 3 ? ", slice through the middle" : "");
}

std::vector<std::string> PictureBook::title(const Quantity& quantity, const Layout& layout) const {
  std::string text = title_ + ": " + caption(quantity);
  if (layout.stretch != 1)
    text +=
        fmt::format(" (heights drawn {:.{}f} times as large as lengths)", layout.stretch, layout.stretch < 10 ? 1 : 0);
  return broken_at_blanks(text, layout.letters_a_line());
}

std::string PictureBook::columns_of_places() const { return fmt::format("($1*{0:g}):($2*{0:g})", 1 / unit_.length); }

/// End of a quantity's scale: the 99th percentile, so that a few outliers do not darken everything else.
static double end_of_scale(std::vector<double> values) {
  const auto at = values.begin() + std::ptrdiff_t(0.99 * double(values.size() - 1));
  std::nth_element(values.begin(), at, values.end());
  return *at > 0 ? *at : 1;
}

/// The least of 1, 2 and 5 times a power of ten that is not below x.
static double round_step(double x) {
  const double power = std::pow(10, std::floor(std::log10(x)));
  for (const double factor : {1, 2, 5})
    if (factor * power >= x) return factor * power;
  return 10 * power;
}

std::string PictureBook::head_of_script(const Quantity& quantity, const Instants& all, const Layout& layout) const {
  const double per_metre = 1 / unit_.length;
  const int width = layout.width(), height = layout.height();
  constexpr double letters_high = 26;  // what a number at a tic takes, and a gap
  std::vector<std::string> lines;
  for (const std::string& line : title(quantity, layout)) lines.push_back(gnuplot_text(line));
  return fmt::format("set terminal pngcairo size {},{} font 'sans,11' background '#ffffff'\n", width, height) +
         "set output " + gnuplot_text(quantity.name + ".png") + "\n" + even_palette() +
         fmt::format("set cbrange [0:{:.3g}]\nset cblabel '{}' offset 1\n", end_of_scale(all.values.at(quantity.name)),
                     quantity.label) +
         "set datafile separator ','\nset key off\nset border 3 lc '#888888'\nset tics nomirror tc '#333333' scale "
         "0.6\n" +
         fmt::format("set colorbox user origin screen {:.4f}, screen {:.4f} size screen {:.4f}, screen {:.4f}\n",
                     double(width - Layout::right + 30) / width, double(Layout::bottom) / height, 16.0 / width,
                     double(layout.bar_height()) / height) +
         fmt::format("set multiplot title {} noenhanced font ',14' offset 0,-0.5\n", fmt::join(lines, ".\"\\n\".")) +
         fmt::format("set xrange [{:.6g}:{:.6g}]\nset yrange [{:.6g}:{:.6g}]\nset ytics {:.6g}\n",
                     per_metre * all.low[0], per_metre * all.high[0], per_metre * all.low[1], per_metre * all.high[1],
                     round_step(per_metre * (all.high[1] - all.low[1]) * letters_high / layout.panel_height));
}

std::string PictureBook::panel_of_script(int number, const Layout& layout) const {
  const int column = number % layout.columns, row = number / layout.columns;
  const bool is_lowest = row == layout.rows - 1 || number + layout.columns >= layout.n;
  const double x0 = Layout::left + column * (layout.panel_width + Layout::gap_x), y1 = layout.end_of_row(row);
  return fmt::format(
             "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\nset bmargin at screen {:.5f}\nset "
             "tmargin at screen {:.5f}\n",
             x0 / layout.width(), (x0 + layout.panel_width) / layout.width(),
             (y1 - layout.panel_height) / layout.height(), y1 / layout.height()) +
         fmt::format("set title 't = {:.3f} s' offset 0,-0.7\n", times_[number]) +
         (column == 0 ? fmt::format("set ylabel '{} [{}]' offset 1\n", dim_ == 3 ? "z" : "y", unit_.name)
                      : "unset ylabel\n") +
         (is_lowest ? fmt::format("set xlabel 'x [{}]' offset 0,0.4\n", unit_.name) : "unset xlabel\n") +
         (number == 1 ? "unset colorbox\n" : "");
}

std::string PictureBook::particles_of_script(int number, long column, double pixels_per_metre, double stretch) const {
  // Discs a fifth larger than particles. Where these have few pixels, squares look alike, of which gnuplot draws four in the time
  // of a disc; they are a pixel wider than particles, so that no gap shows between neighbours.
  constexpr double enlarged = 1.2, largest_square = 4;
  const std::string file = gnuplot_text(instant(number).filename().string());
  const double per_metre = 1 / unit_.length, half_pixel = 0.5 * per_metre / pixels_per_metre;
  const auto those = [&](const char* comparison) {  // no place skips a particle; without a size, gnuplot takes as long
    return fmt::format("{0} skip 2 using ($3 {1} {2:g} ? $1*{3:g} : NaN):($2*{3:g})", file, comparison,
                       largest_square / (pixels_per_metre * std::max(1.0, stretch)), per_metre);
  };
  constexpr const char* look = "fill solid noborder lc palette";
  return fmt::format("{0}:($3*{1:g}+{2:g}):($3*{1:g}+{3:g}):{4} with boxxyerror {5}", those("<="), 0.5 * per_metre,
                     half_pixel, half_pixel / stretch, column, look) +
         fmt::format(", {0}:($3*{1:g}):($3*{1:g}):(0):{2} with ellipses units xy {3}", those(">"), enlarged * per_metre,
                     column, look);
}

std::vector<Picture> PictureBook::draw() const {
  // Instants are read back, so that a run that was stopped and resumed shows the same.
  Instants all = read_instants();
  if (!(all.high[0] > all.low[0])) return {};
  const double margin = 2 * cell_;
  const bool above_floor = all.low[1] - floor_ > 0.25 * (all.high[1] - all.low[1]) + margin;
  all.low[0] -= margin;
  all.low[1] = above_floor ? all.low[1] - margin : floor_;
  for (double& end : all.high) end += margin;
  const double width = all.high[0] - all.low[0], height = all.high[1] - all.low[1];
  Layout layout(int(times_.size()), width, height);

  std::vector<std::string> surfaces;  // what draws them, panel by panel
  for (int i = 0; i < layout.n; ++i)
    surfaces.push_back(solids_.empty()
                           ? ""
                           : fmt::format(", {} skip 1 using {} with points pt 7 ps 0.25 lc '#333333'",
                                         gnuplot_text(write_solids(i, all.low, all.high, width / layout.panel_width)),
                                         columns_of_places()));

  std::vector<Picture> pictures;
  std::vector<std::future<bool>> drawn;
  for (const Quantity& q : quantities) {
    if (!all.values.contains(q.name)) continue;
    const auto is_of_quantity = [&](const std::string& name) { return name.rfind(q.name + " ", 0) == 0; };
    const auto column = std::find_if(all.names.begin(), all.names.end(), is_of_quantity) - all.names.begin() + 1;
    layout.n_title_lines = int(title(q, layout).size());
    std::string script = head_of_script(q, all, layout);
    for (int i = 0; i < layout.n; ++i)
      script += panel_of_script(i, layout) + "plot " +
                particles_of_script(i, column, layout.panel_width / width, layout.stretch) + surfaces[i] + "\n";
    const std::filesystem::path file = folder_ / (q.name + ".gp");
    write_whole(file, script + "unset multiplot\n");
    drawn.push_back(std::async(std::launch::async, [file] { return run_gnuplot(file); }));
    pictures.push_back({folder_ / (q.name + ".png"), caption(q)});
  }
  bool all_drawn = true;
  for (std::future<bool>& picture : drawn) all_drawn &= picture.get();
  if (!all_drawn) pictures.clear();
  return pictures;
}

}  // namespace talus
