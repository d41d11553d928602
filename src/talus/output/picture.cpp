#include "talus/output/picture.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <fstream>

#include "talus/output/plot.hpp"

namespace talus {

PictureBook::PictureBook(std::filesystem::path folder, const Case& what)
    : folder_(std::move(folder)), dim_(what.dim), cell_(what.cell), title_(what.title) {
  shown_ = {{"speed", "Speed", "speed [m/s]", false, {}},
            {"kappa", "Equivalent plastic strain", "plastic strain [-]", false, {}},
            {"viscosity", "Equivalent shear viscosity", "viscosity 2 f_{/Symbol F} {/Symbol m}|g| [Pa s]", false, {}}};
  Box box = bounding_box(what.bodies.at(0).region, dim_);
  slice_ = 0.5 * (box.min[1] + box.max[1]);
  for (int a = 0; a < 2; ++a) {
    low_[a] = 1e300;
    high_[a] = -1e300;
  }
  low_[1] = what.domain.min[dim_ - 1];
  std::filesystem::create_directories(folder_);
}

void PictureBook::add(const Observation& seen) {
  const Field &x = seen.fields.at(0), &v = *seen.find("velocity"), &volume = *seen.find("volume");
  const Instant instant{seen.time, fmt::format("instant_{}.csv", instants_.size())};
  std::ofstream out(folder_ / instant.file);
  out << "# t = " << seen.time << " s\n" << (dim_ == 3 ? "x [m],z [m]" : "x [m],y [m]") << ",size [m]";
  std::vector<const Field*> fields;
  for (Shown& s : shown_) {
    fields.push_back(s.name == "speed" ? nullptr : seen.find(s.name));
    s.present = s.name == "speed" || fields.back();
    if (s.present) out << "," << s.name << (s.name == "speed" ? " [m/s]" : " [" + fields.back()->unit + "]");
  }
  out << "\n";
  const int up = dim_ - 1;
  for (int i = 0; i < seen.n_particles(); ++i) {
    if (dim_ == 3 && std::abs(x.values[3 * i + 1] - slice_) > 0.5 * cell_) continue;
    const double h = x.values[3 * i], z = x.values[3 * i + up], size = std::pow(volume.values[i], 1.0 / dim_);
    low_[0] = std::min(low_[0], h);
    high_[0] = std::max(high_[0], h);
    high_[1] = std::max(high_[1], z);
    out << fmt::format("{:.6g},{:.6g},{:.3g}", h, z, std::min(size, cell_));
    for (std::size_t k = 0; k < shown_.size(); ++k) {
      if (!shown_[k].present) continue;
      const double value =
          fields[k] ? fields[k]->values[i] : std::hypot(v.values[3 * i], v.values[3 * i + 1], v.values[3 * i + 2]);
      out << fmt::format(",{:.4g}", value);
      shown_[k].values.push_back(float(value));
    }
    out << "\n";
  }
  instants_.push_back(instant);
}

std::vector<Picture> PictureBook::draw() {
  std::vector<Picture> pictures;
  if (instants_.empty() || !(high_[0] > low_[0])) return pictures;
  const double margin = 2 * cell_;
  const double width = high_[0] - low_[0] + 2 * margin, height = high_[1] - low_[1] + margin;
  const int n = int(instants_.size()), columns = n > 1 ? 2 : 1, rows = (n + columns - 1) / columns;
  // Panels of equal scale; room for tics, titles and the colour bar in pixels.
  const int panel_w = 560, panel_h = std::clamp(int(panel_w * height / width), 60, 700), gap_x = 70, gap_y = 64,
            left = 80, right = 140, top = 70, bottom = 60;
  const int total_w = left + columns * panel_w + (columns - 1) * gap_x + right,
            total_h = top + rows * panel_h + (rows - 1) * gap_y + bottom;

  int column = 3;
  for (Shown& s : shown_) {
    if (!s.present) continue;
    ++column;
    // The scale ends at the 99th percentile, so that a few outliers do not darken everything else.
    std::erase_if(s.values, [](float v) { return !std::isfinite(v); });
    if (s.values.empty()) continue;
    auto at = s.values.begin() + std::ptrdiff_t(0.99 * double(s.values.size() - 1));
    std::nth_element(s.values.begin(), at, s.values.end());
    const double most = *at > 0 ? *at : 1;
    const std::filesystem::path script = folder_ / (s.name + ".gp"), image = folder_ / (s.name + ".png");
    std::ofstream out(script);
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
        << fmt::format("set xrange [{:.6g}:{:.6g}]\nset yrange [{:.6g}:{:.6g}]\n", 1e3 * (low_[0] - margin),
                       1e3 * (high_[0] + margin), 1e3 * low_[1], 1e3 * (low_[1] + height));
    for (int i = 0; i < n; ++i) {
      const int c = i % columns, r = i / columns;
      const double x0 = left + c * (panel_w + gap_x), y1 = total_h - top - r * (panel_h + gap_y);
      out << fmt::format(
                 "set lmargin at screen {:.5f}\nset rmargin at screen {:.5f}\nset bmargin at screen {:.5f}\nset "
                 "tmargin at screen {:.5f}\n",
                 x0 / total_w, (x0 + panel_w) / total_w, (y1 - panel_h) / total_h, y1 / total_h)
          << fmt::format("set title 't = {:.3f} s' offset 0,-0.7\n", instants_[i].time)
          << (c == 0 ? fmt::format("set ylabel '{} [mm]' offset 1\n", dim_ == 3 ? "z" : "y") : "unset ylabel\n")
          << (r == rows - 1 || i + columns >= n ? "set xlabel 'x [mm]' offset 0,0.4\n" : "unset xlabel\n")
          << (i == 1 ? "unset colorbox\n" : "")
          << fmt::format(
                 "plot {} skip 2 using ($1*1e3):($2*1e3):($3*0.6e3):{} with circles fill solid noborder lc palette\n",
                 gnuplot_text(instants_[i].file), column);
    }
    out << "unset multiplot\n";
    out.close();
    if (!run_gnuplot(script)) return {};
    pictures.push_back({image, s.title + (dim_ == 3 ? ", slice through the middle" : "")});
  }
  return pictures;
}

}  // namespace talus
