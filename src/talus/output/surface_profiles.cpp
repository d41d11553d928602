#include "talus/output/surface_profiles.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "talus/base/table.hpp"
#include "talus/base/units.hpp"

namespace talus {

namespace {

/// The rows of one instant.
struct Profile {
  double time;
  std::vector<std::pair<double, double>> points;  ///< place and thickness [m]
};

std::vector<Profile> profiles_in(const NumberTable& table) {
  std::vector<Profile> profiles;
  for (const std::vector<double>& row : table.rows) {
    if (profiles.empty() || profiles.back().time != row[0]) profiles.push_back({row[0], {}});
    if (std::isfinite(row[1]) && std::isfinite(row[2])) profiles.back().points.emplace_back(row[1], row[2]);
  }
  std::erase_if(profiles, [](const Profile& p) { return p.points.size() < 2; });
  return profiles;
}

/// At most so many profiles, evenly, the first and the last among them.
std::vector<Profile> some_of(const std::vector<Profile>& all, std::size_t most) {
  if (all.size() <= most) return all;
  std::vector<Profile> some;
  for (std::size_t i = 0; i < most; ++i) some.push_back(all[(i * (all.size() - 1) + (most - 1) / 2) / (most - 1)]);
  return some;
}

/// 1, 2 or 5 times a power of ten, so that some four to nine of them make `length`.
double tick_of(double length) {
  const double ten = std::pow(10, std::floor(std::log10(length / 4)));
  for (const double m : {5.0, 2.0})
    if (m * ten <= length / 4) return m * ten;
  return ten;
}

/// A plot with axes in a unit of length.
class Drawing {
 public:
  Drawing(double low, double high, double top, const LengthUnit& unit)
      : low_(low), high_(high), top_(top), unit_(unit) {
    const double true_height = plot_width * top / (high - low);
    plot_height_ = std::clamp(true_height, 120.0, 300.0);
  }

  std::string axes(const std::string& along) const {
    std::string svg;
    const double step_x = tick_of((high_ - low_) / unit_.length), step_y = tick_of(top_ / unit_.length);
    for (double x = std::ceil(low_ / unit_.length / step_x) * step_x; x <= high_ / unit_.length * (1 + 1e-9);
         x += step_x)
      svg += tick(x, step_x, true);
    for (double y = 0; y <= top_ / unit_.length * (1 + 1e-9); y += step_y) svg += tick(y, step_y, false);
    svg += fmt::format("<path d=\"M{0:.1f} {1:.1f}V{2:.1f}H{3:.1f}\" stroke=\"#333\" fill=\"none\"/>\n", left, margin,
                       margin + plot_height_, left + plot_width);
    svg += fmt::format("<text x=\"{:.1f}\" y=\"{:.1f}\" text-anchor=\"middle\">{} [{}]</text>\n", left + plot_width / 2,
                       height() - 6, along, unit_.name);
    return svg + fmt::format(
                     "<text transform=\"translate(14 {:.1f}) rotate(-90)\" text-anchor=\"middle\">thickness "
                     "[{}]</text>\n",
                     margin + plot_height_ / 2, unit_.name);
  }

  std::string curve(const Profile& profile, const std::string& colour, double width) const {
    std::string points;
    for (const auto& [x, thickness] : profile.points) points += fmt::format("{:.1f},{:.1f} ", across(x), up(thickness));
    return fmt::format("<polyline points=\"{}\" fill=\"none\" stroke=\"{}\" stroke-width=\"{:g}\"/>\n", points, colour,
                       width);
  }

  std::string legend(const Profile& profile, const std::string& colour, std::size_t number) const {
    const double y = margin + 8 + 18 * double(number), x = left + plot_width + 14;
    return fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}h18\" stroke=\"{2}\" stroke-width=\"3\"/><text x=\"{3:.1f}\" y=\"{4:.1f}\">t = "
        "{5:.3g} "
        "s</text>\n",
        x, y, colour, x + 24, y + 4, profile.time);
  }

  double width() const { return left + plot_width + 120; }
  double height() const { return margin + std::max(plot_height_, 130.0) + 46; }

 private:
  static constexpr double left = 70, plot_width = 700, margin = 10;

  double across(double x) const { return left + plot_width * (x - low_) / (high_ - low_); }
  double up(double thickness) const { return margin + plot_height_ * (1 - thickness / top_); }
  std::string tick(double value, double step, bool is_across) const {
    const std::string number = fmt::format("{:g}", std::abs(value) < 1e-6 * step ? 0 : value);
    if (is_across)
      return fmt::format(
          "<path d=\"M{0:.1f} {1:.1f}v5\" stroke=\"#333\"/><text x=\"{0:.1f}\" y=\"{2:.1f}\" "
          "text-anchor=\"middle\">{3}</text>\n",
          across(value * unit_.length), margin + plot_height_, margin + plot_height_ + 18, number);
    return fmt::format(
        "<path d=\"M{0:.1f} {1:.1f}h-5\" stroke=\"#333\"/><text x=\"{2:.1f}\" y=\"{3:.1f}\" "
        "text-anchor=\"end\">{4}</text>\n",
        left, up(value * unit_.length), left - 8, up(value * unit_.length) + 4, number);
  }

  double low_, high_, top_, plot_height_;
  LengthUnit unit_;
};

}  // namespace

std::string surface_profiles(const std::filesystem::path& surface, double extent) {
  const NumberTable table = read_csv(surface.string());
  if (table.names.size() < 3) return "";
  const std::vector<Profile> profiles = some_of(profiles_in(table), 7);
  if (profiles.size() < 2) return "";
  double low = INFINITY, high = -INFINITY, top = 0;
  for (const Profile& p : profiles)
    for (const auto& [x, thickness] : p.points) {
      low = std::min(low, x);
      high = std::max(high, x);
      top = std::max(top, thickness);
    }
  if (!(high > low && top > 0)) return "";
  // Seven samples of viridis from dark to light (Smith and van der Walt 2015, CC0), the last in red: the deposit.
  static constexpr const char* colours[] = {"#440154", "#443a83", "#31688e", "#21908c", "#35b779", "#8fd744"};
  const Drawing drawing(low, high, 1.05 * top, length_unit_for(extent));
  std::string curves, legend;
  for (std::size_t i = 0; i < profiles.size(); ++i) {
    const bool is_last = i + 1 == profiles.size();
    const std::string colour = is_last ? "#d55e00" : colours[i * 6 / (profiles.size() - 1)];
    curves += drawing.curve(profiles[i], colour, is_last ? 3 : 1.5);
    legend += drawing.legend(profiles[i], colour, i);
  }
  return fmt::format(
      "<h2>Profiles of the surface</h2>\n<figure class=\"profiles\"><svg xmlns=\"http://www.w3.org/2000/svg\" "
      "viewBox=\"0 0 "
      "{0:.0f} {1:.0f}\" width=\"{0:.0f}\" height=\"{1:.0f}\" font-family=\"system-ui, sans-serif\" font-size=\"13\" "
      "fill=\"#333\" role=\"img\" aria-label=\"Thickness at some instants\">\n{2}{3}{4}</svg><figcaption>Thickness of "
      "the "
      "material at {5} instants; the last is drawn thick. All instants are in {6}.</figcaption></figure>\n",
      drawing.width(), drawing.height(), drawing.axes(table.names[1].starts_with("radius") ? "radius" : "x"), curves,
      legend, profiles.size(), surface.filename().string());
}

}  // namespace talus
