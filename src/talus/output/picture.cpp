#include "talus/output/picture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <map>
#include <sstream>

#include "talus/base/file.hpp"
#include "talus/base/table.hpp"
#include "talus/output/plot.hpp"

namespace talus {

namespace {

/// A quantity that pictures show where the laws tell it.
struct Shown {
  std::string name, title, label;
};
const std::vector<Shown> quantities = {
    {"speed", "Speed", "speed [m/s]"},
    {"kappa", "Equivalent plastic strain", "plastic strain [-]"},
    {"viscosity", "Equivalent shear viscosity", "viscosity 2 f_{/Symbol F} {/Symbol m}|g| [Pa s]"}};

}  // namespace

PictureBook::PictureBook(std::filesystem::path folder, const Case& what, std::vector<double> times)
    : folder_(std::move(folder)),
      dim_(what.dim),
      axisymmetric_(what.axisymmetric),
      cell_(what.cell),
      unit_(length_unit_for(extent(what))),
      title_(what.title),
      solids_(what.solids),
      times_(std::move(times)) {
  const Box box = bounding_box(what.bodies.at(0).region, dim_);
  slice_ = 0.5 * (box.min[1] + box.max[1]);
  floor_ = what.domain.min[dim_ - 1];
  std::filesystem::create_directories(folder_);
}

std::filesystem::path PictureBook::instant(int number) const { return folder_ / fmt::format("instant_{}.csv", number); }

void PictureBook::add(const Observation& seen) {
  const Field &x = seen.fields.at(0), &v = *seen.find("velocity"), &volume = *seen.find("volume");
  std::ostringstream out;
  out << "# t = " << seen.time << " s\n" << (dim_ == 3 ? "x [m],z [m]" : "x [m],y [m]") << ",size [m],speed [m/s]";
  std::vector<const Field*> fields;
  for (const Shown& s : quantities)
    if (const Field* f = seen.find(s.name)) {
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
  const std::string name = fmt::format("solids_{}.csv", number);
  write_whole(folder_ / name, rows);
  return name;
}

std::vector<Picture> PictureBook::draw() const {
  std::vector<Picture> pictures;
  // What is shown is read back, so that a run that was stopped and gone on with shows the same.
  double low[2] = {1e300, floor_}, high[2] = {-1e300, -1e300};
  std::vector<std::string> names;
  std::map<std::string, std::vector<double>> values;  // of all instants, for the scales
  for (std::size_t i = 0; i < times_.size(); ++i) {
    const NumberTable table = read_csv(instant(int(i)).string());
    names = table.names;
    for (const auto& row : table.rows) {
      low[0] = std::min(low[0], row[0]);
      for (int a = 0; a < 2; ++a) high[a] = std::max(high[a], row[a]);
      for (std::size_t c = 3; c < row.size(); ++c)
        if (std::isfinite(row[c])) values[names[c].substr(0, names[c].find(' '))].push_back(row[c]);
    }
  }
  if (!(high[0] > low[0])) return pictures;
  const double margin = 2 * cell_;
  low[0] -= margin;
  for (double& end : high) end += margin;
  const double width = high[0] - low[0], height = high[1] - low[1];
  const int n = int(times_.size()), columns = n > 1 ? 2 : 1, rows = (n + columns - 1) / columns;
  // Panels of equal scale; room for tics, titles and the colour bar in pixels.
  const int panel_w = 560, panel_h = std::clamp(int(panel_w * height / width), 60, 700), gap_x = 70, gap_y = 64,
            left = 80, right = 140, top = 70, bottom = 60;
  const int total_w = left + columns * panel_w + (columns - 1) * gap_x + right,
            total_h = top + rows * panel_h + (rows - 1) * gap_y + bottom;

  // Columns of the files in the unit of the axes: x, y and half the size of a particle, drawn a fifth larger.
  const double per_metre = 1 / unit_.length;
  const std::string places = fmt::format("($1*{0:g}):($2*{0:g})", per_metre);

  std::vector<std::string> surfaces;  // what draws them, panel by panel
  for (int i = 0; i < n; ++i)
    surfaces.push_back(solids_.empty()
                           ? ""
                           : fmt::format(", {} skip 1 using {} with points pt 7 ps 0.25 lc '#333333'",
                                         gnuplot_text(write_solids(i, low, high, width / panel_w)), places));

  for (const Shown& s : quantities) {
    if (!values.contains(s.name)) continue;
    const auto named = [&](const std::string& name) { return name.rfind(s.name + " ", 0) == 0; };
    const int column = int(std::find_if(names.begin(), names.end(), named) - names.begin()) + 1;
    // The scale ends at the 99th percentile, so that a few outliers do not darken everything else.
    std::vector<double>& all = values[s.name];
    const auto at = all.begin() + std::ptrdiff_t(0.99 * double(all.size() - 1));
    std::nth_element(all.begin(), at, all.end());
    const double most = *at > 0 ? *at : 1;
    const std::filesystem::path script = folder_ / (s.name + ".gp"), image = folder_ / (s.name + ".png");
    std::ostringstream out;
    out << fmt::format("set terminal pngcairo size {},{} font 'sans,11' background '#ffffff'\n", total_w, total_h)
        << "set output " << gnuplot_text(image.filename().string()) << "\n"
        << even_palette() << fmt::format("set cbrange [0:{:.3g}]\nset cblabel '{}' offset 1\n", most, s.label)
        << "set datafile separator ','\nset key off\nset border 3 lc '#888888'\nset tics nomirror tc '#333333' scale "
           "0.6\n"
        << fmt::format("set colorbox user origin screen {:.4f}, screen {:.4f} size screen {:.4f}, screen {:.4f}\n",
                       double(total_w - right + 30) / total_w, double(bottom) / total_h, 16.0 / total_w,
                       double(total_h - top - bottom) / total_h)
        << fmt::format("set multiplot title {} font ',14' offset 0,-0.5\n",
                       gnuplot_text(title_ + ": " + s.title + (dim_ == 3 ? ", slice through the middle" : "")))
        << fmt::format("set xrange [{:.6g}:{:.6g}]\nset yrange [{:.6g}:{:.6g}]\n", per_metre * low[0],
                       per_metre * high[0], per_metre * low[1], per_metre * high[1]);
    for (int i = 0; i < n; ++i) {
      const int c = i % columns, r = i / columns;
      const double x0 = left + c * (panel_w + gap_x), y1 = total_h - top - r * (panel_h + gap_y);
      out << fmt::format(
                 "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\nset bmargin at screen {:.5f}\nset "
                 "tmargin at screen {:.5f}\n",
                 x0 / total_w, (x0 + panel_w) / total_w, (y1 - panel_h) / total_h, y1 / total_h)
          << fmt::format("set title 't = {:.3f} s' offset 0,-0.7\n", times_[i])
          << (c == 0 ? fmt::format("set ylabel '{} [{}]' offset 1\n", dim_ == 3 ? "z" : "y", unit_.name)
                     : "unset ylabel\n")
          << (r == rows - 1 || i + columns >= n ? fmt::format("set xlabel 'x [{}]' offset 0,0.4\n", unit_.name)
                                                : "unset xlabel\n")
          << (i == 1 ? "unset colorbox\n" : "")
          << fmt::format("plot {} skip 2 using {}:($3*{:g}):{} with circles fill solid noborder lc palette{}\n",
                         gnuplot_text(instant(i).filename().string()), places, 0.6 * per_metre, column, surfaces[i]);
    }
    out << "unset multiplot\n";
    write_whole(script, out.str());
    if (!run_gnuplot(script)) return {};
    pictures.push_back({image, s.title + (dim_ == 3 ? ", slice through the middle" : "")});
  }
  return pictures;
}

}  // namespace talus
