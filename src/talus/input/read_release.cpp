#include <fmt/format.h>

#include <numbers>

#include "talus/base/units.hpp"
#include "talus/case/defaults.hpp"
#include "talus/input/map_files.hpp"

namespace talus {

namespace {

/// Thicker releases are mistakes of units.
constexpr double most_thickness = 2000;

constexpr Text polygons{"polygons", "outlines: a shapefile, GeoPackage or GeoJSON"};
constexpr Parameter even_thickness{
    "thickness", "m", {.low = 0, .high = most_thickness, .open_low = true}, "how thick it is everywhere"};
constexpr Text attribute{"attribute", "name of the polygons' attribute that says how thick each is"};
constexpr Text raster{"raster", "how thick it is: an ESRI ASCII raster or a GeoTIFF"};
constexpr Text top{"top", "heights of its surface, above the terrain: an ESRI ASCII raster or a GeoTIFF"};
constexpr Text bottom{"bottom", "heights of its underside, where `top` lies above another layer than the terrain"};
constexpr Text unit{"unit", "unit of the numbers of `attribute`, `raster`, `top` and `bottom`, such as \"m\""};
constexpr Choice directions[] = {{"normal", "across the ground"}, {"vertical", "straight up"}};
constexpr Option measured{"measured", "how thickness is measured", directions};

/// What a release says of its thickness.
struct Release {
  std::shared_ptr<const Terrain> base;  ///< that it lies on
  std::optional<GeoPolygons> outlines;
  std::optional<PlanRaster> raster;  ///< of thickness
  double thickness = 0;              ///< where neither raster nor polygons have it [m]
  bool normal = false;               ///< measured across the ground
};

/// A release on pixels as wide as its particles stand apart.
struct Layer {
  PlanRaster thickness;  ///< upright, the mean over the pixel [m]
  PlanRaster covered;    ///< share of the pixel that lies in the release; of polygons that overlap, the sum
};

template <class F>
void for_each_pixel(const PlanRaster& pixels, F f) {
  for (int row = 0; row < pixels.rows; ++row)
    for (int column = 0; column < pixels.columns; ++column) f(column, row);
}

/// The first pixel, from the south-west, of which f(column, row) is true.
template <class F>
std::optional<Index<2>> find_pixel(const PlanRaster& pixels, F f) {
  for (int row = 0; row < pixels.rows; ++row)
    for (int column = 0; column < pixels.columns; ++column)
      if (f(column, row)) return Index<2>{column, row};
  return std::nullopt;
}

PlanRaster covered_by(const GeoPolygons& outlines, const PlanRaster& pixels) {
  PlanRaster sum = pixels;
  std::ranges::fill(sum.values, 0.0);
  for (const GeoPolygon& polygon : outlines.polygons) {
    const PlanRaster covered = coverage(polygon, pixels);
    for (std::size_t i = 0; i < sum.values.size(); ++i) sum.values[i] += covered.values[i];
  }
  return sum;
}

/// Whether polygons reach beyond a raster; `covered` is the share of its pixels that they cover.
bool is_beyond(const GeoPolygons& outlines, const PlanRaster& covered) {
  double whole = 0, here = 0;
  for (const GeoPolygon& polygon : outlines.polygons) whole += area(polygon);
  for (const double share : covered.values) here += share * covered.pixel * covered.pixel;
  return here < (1 - 1e-6) * whole;
}

// ---- what the user gave ------------------------------------------------------------------------------------------

/// Converts what an attribute says of each polygon into m.
void convert_attribute(Section& s, double metres, GeoPolygons& outlines) {
  std::size_t n = 0;
  for (GeoPolygon& polygon : outlines.polygons) {
    ++n;
    if (!polygon.value) continue;
    *polygon.value *= metres;
    if (!even_thickness.range.contains(*polygon.value))
      return s.complain(
          "attribute", fmt::format("is {} of polygon {} of {}; thickness must be {}", with_unit(*polygon.value, "m"), n,
                                   outlines.polygons.size(), in_words(even_thickness.range, "m")));
  }
}

/// Height of a surface above the ground of a layer, where both are known [m].
PlanRaster height_above(const PlanRaster& surface, const Terrain& ground) {
  constexpr double least = 1e-3;            // heights are written with so many digits
  const Terrain heights(ground.heights());  // without smoothing: the surface has none either
  PlanRaster above = surface;
  for_each_pixel(surface, [&](int column, int row) {
    const Vec<2> at = surface.middle(column, row);
    double& t = above.at(column, row);
    t = heights.is_known(at[0], at[1]) ? t - heights.at(at[0], at[1]).height : PlanRaster::none;
    if (std::abs(t) < least) t = 0;
  });
  return above;
}

/// What is wrong with the thickness of a pixel that counts. `below`: what a surface lies above; empty without one.
std::string fault_of_thickness(double here, const std::string& below, const std::string& place) {
  if (std::isnan(here)) return fmt::format("has no number at {}, inside the polygons", place);
  if (here < 0 && !below.empty())
    return fmt::format(
        "lies {} below {} at {}; raise it to {} where nothing is released, or name `polygons` around the "
        "release",
        with_unit(-here, "m"), below, place, below);
  return fmt::format("means a thickness of {} at {}; it must be {}", with_unit(here, "m"), place,
                     in_words(Range::between(0, most_thickness), "m"));
}

/// Pixels without data that a release of a raster surrounds: a path between pixels side by side or corner to corner, over
/// pixels that hold no thickness, leads from none of them to the edge of the raster.
struct Enclosed {
  long n = 0;
  Vec<2> first{};  ///< the middle of one [m]
};

Enclosed enclosed_gaps(const PlanRaster& t) {
  std::vector<char> is_reached(t.values.size(), 0);
  std::vector<Index<2>> next;
  const auto reach = [&](int column, int row) {
    if (!t.has_pixel(column, row) || t.at(column, row) > 0 || is_reached[t.index(column, row)]) return;
    is_reached[t.index(column, row)] = 1;
    next.push_back({column, row});
  };
  for_each_pixel(t, [&](int column, int row) {
    if (column == 0 || row == 0 || column + 1 == t.columns || row + 1 == t.rows) reach(column, row);
  });
  while (!next.empty()) {
    const Index<2> from = next.back();
    next.pop_back();
    for (int column = from[0] - 1; column <= from[0] + 1; ++column)
      for (int row = from[1] - 1; row <= from[1] + 1; ++row) reach(column, row);
  }
  Enclosed enclosed;
  for_each_pixel(t, [&](int column, int row) {
    if (!std::isnan(t.at(column, row)) || is_reached[t.index(column, row)]) return;
    if (enclosed.n++ == 0) enclosed.first = t.middle(column, row);
  });
  return enclosed;
}

/// Complains where a raster of thickness holds no thickness. Beside the polygons, if there are any, nothing counts.
void check_raster(Section& s, const MapFrame& frame, Release& release) {
  PlanRaster& t = *release.raster;
  const std::string_view key = s.has("top") ? "top" : "raster";
  const PlanRaster inside = release.outlines ? covered_by(*release.outlines, t) : PlanRaster{};
  if (release.outlines && is_beyond(*release.outlines, inside))
    return s.complain(key, fmt::format("does not cover the polygons; it reaches from {} to {}", on_map(t.corner, frame),
                                       on_map(t.far_corner(), frame)));
  const auto counts = [&](int column, int row) { return !release.outlines || inside.at(column, row) > 0.5; };
  const auto wrong = find_pixel(t, [&](int column, int row) {
    const double here = t.at(column, row);
    return counts(column, row) && (std::isnan(here) ? release.outlines.has_value() : here < 0 || here > most_thickness);
  });
  if (wrong)
    return s.complain(key, fault_of_thickness(t.at((*wrong)[0], (*wrong)[1]),
                                              key != "top"      ? ""
                                              : s.has("bottom") ? "`bottom`"
                                                                : "the terrain",
                                              on_map(t.middle((*wrong)[0], (*wrong)[1]), frame)));
  if (const Enclosed gaps = release.outlines ? Enclosed{} : enclosed_gaps(t); gaps.n > 0)
    return s.complain(
        key,
        fmt::format("has no data in {} pixel{} that the release surrounds, such as at {}; write {} there if nothing "
                    "is released, or fill them: gdal_fillnodata.py IN OUT",
                    gaps.n, gaps.n > 1 ? "s" : "", on_map(gaps.first, frame),
                    key == "top" ? "the height below the release" : "0"));
  for_each_pixel(t, [&](int column, int row) {
    if (!counts(column, row)) t.at(column, row) = std::max(t.at(column, row), 0.0);  // none stays none
  });
}

void read_polygons_of(Section& s, const std::string& folder, double metres, MapOfCase& map, Release& release) {
  const std::string name = s.has("attribute") ? s.text(attribute) : "";
  if (s.has("polygons"))
    release.outlines = read_outlines(s, polygons, folder, name, map);
  else if (s.has("thickness") || s.has("attribute"))
    s.complain("`polygons` is missing: the outlines of the release");
  if (release.outlines) convert_attribute(s, metres, *release.outlines);
}

/// What a release lies on: the terrain, or the surface that it names.
std::shared_ptr<const Terrain> read_base(Section& s, const std::string& folder, double metres, double cell,
                                         MapOfCase& map) {
  if (!s.has("bottom")) return map.ground;
  if (!s.has("top")) expect_absent(s, {"bottom"}, "top");
  std::optional<PlanRaster> heights = read_map_raster(s, bottom, folder, metres, RasterContent::heights, map);
  if (!heights) return map.ground;
  if (heights->columns >= 2 && heights->rows >= 2) return std::make_shared<const Terrain>(std::move(*heights), cell);
  s.complain("bottom",
             fmt::format("has {} x {} pixels, and at least 2 x 2 are needed", heights->columns, heights->rows));
  return map.ground;
}

Release read_source(Section& s, const std::string& folder, double cell, MapOfCase& map) {
  Release release;
  s.expect_one_of();
  double metres = 1;
  if (s.has("attribute") || s.has("raster") || s.has("top") || s.has("bottom"))
    metres = metres_of(s, unit);
  else
    expect_absent(s, {"unit"}, "attribute`, `raster` or `top");
  if (s.has("thickness")) release.thickness = s.number(even_thickness);
  read_polygons_of(s, folder, metres, map, release);
  release.base = read_base(s, folder, metres, cell, map);
  if (s.has("raster")) release.raster = read_map_raster(s, raster, folder, metres, RasterContent::any, map);
  if (s.has("top")) {
    release.raster = read_map_raster(s, top, folder, metres, RasterContent::heights, map);
    if (release.raster) release.raster = height_above(*release.raster, *release.base);
    expect_absent(s, {"measured"}, "thickness`, `attribute` or `raster");
  } else {
    release.normal = s.required_choice(measured) == 0;
  }
  if (release.raster) check_raster(s, map.frame, release);
  return release;
}

// ---- on the pixels of the particles ------------------------------------------------------------------------------

/// The smallest rectangle around a release.
struct Rectangle {
  Vec<2> low{INFINITY, INFINITY}, high{-INFINITY, -INFINITY};

  void include(const Vec<2>& x) {
    for (int a = 0; a < 2; ++a) low[a] = std::min(low[a], x[a]), high[a] = std::max(high[a], x[a]);
  }
  bool is_empty() const { return !(high[0] > low[0] && high[1] > low[1]); }
};

Rectangle rectangle_around(const Release& release) {
  Rectangle around;
  if (release.outlines) {
    for (const GeoPolygon& polygon : release.outlines->polygons)
      for (const auto& ring : polygon.rings)
        for (const Vec<2>& x : ring) around.include(x);
    return around;
  }
  const PlanRaster& r = *release.raster;
  const Vec<2> half{0.5 * r.pixel, 0.5 * r.pixel};
  for_each_pixel(r, [&](int column, int row) {
    if (!(r.at(column, row) > 0)) return;
    around.include(r.middle(column, row) - half);
    around.include(r.middle(column, row) + half);
  });
  return around;
}

/// The pixels, whole spacings from the origin, that a release touches; none if they are too many.
PlanRaster pixels_over(const Rectangle& around, double spacing) {
  Vec<2> corner, number;
  for (int a = 0; a < 2; ++a) {
    corner[a] = std::floor(around.low[a] / spacing + 1e-9) * spacing;
    number[a] = std::ceil((around.high[a] - corner[a]) / spacing - 1e-9);
  }
  if (!(number[0] * number[1] <= most_raster_pixels)) return {};
  return PlanRaster::of(corner, spacing, int(number[0]), int(number[1]), 0);
}

/// Sums over the part of a square that a raster covers.
struct SumsOverSquare {
  double thickness = 0;  ///< times area [m3]
  double area = 0;       ///< where the thickness is greater than 0 [m2]
};

SumsOverSquare sums_over(const PlanRaster& r, Vec<2> low, double edge) {
  SumsOverSquare sums;
  const int first_row = std::max(0, r.row_of(low[1])), last_row = std::min(r.rows - 1, r.row_of(low[1] + edge));
  const int first = std::max(0, r.column_of(low[0])), last = std::min(r.columns - 1, r.column_of(low[0] + edge));
  for (int row = first_row; row <= last_row; ++row)
    for (int column = first; column <= last; ++column) {
      if (!(r.at(column, row) > 0)) continue;
      const Vec<2> middle = r.middle(column, row);
      double area = 1;
      for (int a = 0; a < 2; ++a)
        area *= std::max(
            0.0, std::min(middle[a] + 0.5 * r.pixel, low[a] + edge) - std::max(middle[a] - 0.5 * r.pixel, low[a]));
      sums.thickness += area * r.at(column, row);
      sums.area += area;
    }
  return sums;
}

/// Thickness as it was measured.
Layer layer_as_measured(const Release& release, const PlanRaster& pixels) {
  Layer layer{pixels, pixels};
  if (release.outlines) {
    for (const GeoPolygon& polygon : release.outlines->polygons) {
      const PlanRaster covered = coverage(polygon, pixels);
      const double of_polygon = release.raster ? 1 : polygon.value.value_or(release.thickness);
      for (std::size_t i = 0; i < covered.values.size(); ++i) {
        layer.covered.values[i] += covered.values[i];
        layer.thickness.values[i] += covered.values[i] * of_polygon;
      }
    }
  } else {
    std::ranges::fill(layer.thickness.values, 1.0);
  }
  if (!release.raster) return layer;
  const double edge = pixels.pixel;
  for_each_pixel(pixels, [&](int column, int row) {
    double& t = layer.thickness.at(column, row);
    if (!(t > 0)) return;
    const SumsOverSquare sums =
        sums_over(*release.raster, pixels.middle(column, row) - Vec<2>{0.5 * edge, 0.5 * edge}, edge);
    t *= sums.thickness / (edge * edge);
    if (!release.outlines) layer.covered.at(column, row) = sums.area / (edge * edge);
  });
  return layer;
}

Layer upright_layer(const Release& release, const Terrain& ground, const PlanRaster& pixels) {
  Layer layer = layer_as_measured(release, pixels);
  if (!release.normal) return layer;
  for_each_pixel(pixels, [&](int column, int row) {
    const Vec<2> at = pixels.middle(column, row);
    if (double& t = layer.thickness.at(column, row); t > 0) t /= ground.at(at[0], at[1]).cosine();
  });
  return layer;
}

/// Why the surface that a release lies on is refused; empty if it is the terrain, or right.
std::string fault_of_base(const PlanRaster& t, const Terrain& base, const MapOfCase& map) {
  if (&base == map.ground.get()) return "";
  const auto unknown = find_pixel(t, [&](int column, int row) {
    const Vec<2> at = t.middle(column, row);
    return t.at(column, row) > 0 && !base.is_known(at[0], at[1]);
  });
  if (unknown)
    return fmt::format("lies where `bottom` has no data, at {}",
                       on_map(t.middle((*unknown)[0], (*unknown)[1]), map.frame));
  // Rasters of other pixels differ a little between them; the lowest particles stand half a pixel above the base.
  const double close = 0.25 * t.pixel;
  const auto buried = [&](const Vec<2>& at) {
    return map.ground->at(at[0], at[1]).height - base.at(at[0], at[1]).height;
  };
  const auto below = find_pixel(
      t, [&](int column, int row) { return t.at(column, row) > 0 && buried(t.middle(column, row)) > close; });
  if (!below) return "";
  const Vec<2> at = t.middle((*below)[0], (*below)[1]);
  return fmt::format("has a `bottom` that lies {} below the terrain at {}; raise it to the terrain",
                     with_unit(buried(at), "m"), on_map(at, map.frame));
}

/// Why a release may not lie at a place where the ground is unknown.
std::string fault_of_place(const Vec<2>& at, const MapOfCase& map, const std::optional<TerrainCrop>& crop) {
  const PlanRaster& heights = map.ground->heights();
  const int column = heights.column_of(at[0]), row = heights.row_of(at[1]);
  const bool is_on_pixel = heights.has_pixel(column, row);
  const Vec<2> low = crop ? crop->low : heights.corner, high = crop ? crop->high : heights.far_corner();
  if (at[0] < low[0] || at[1] < low[1] || at[0] > high[0] || at[1] > high[1])
    return fmt::format("lies outside the terrain at {}; the terrain reaches from {} to {}", on_map(at, map.frame),
                       on_map(low, map.frame), on_map(high, map.frame));
  if (!is_on_pixel)
    return fmt::format("lies outside the crop at {}; `{}` reaches from {} to {}; move the release, or enlarge the crop",
                       on_map(at, map.frame), crop->key, on_map(heights.corner, map.frame),
                       on_map(heights.far_corner(), map.frame));
  const TerrainCrop::Pixel part =
      crop && !crop->pixels.empty() ? crop->pixels[heights.index(column, row)] : TerrainCrop::kept;
  if (part == TerrainCrop::in_hole)
    return fmt::format("lies outside the crop at {}, in a hole of `{}`; move the release, or change the crop",
                       on_map(at, map.frame), crop->key);
  if (part == TerrainCrop::beside)
    return fmt::format(
        "lies outside the crop at {}; `{}` cover half of this pixel or less; move the release, or enlarge the crop",
        on_map(at, map.frame), crop->key);
  return fmt::format(
      "lies where the terrain has no data, at {}; move its outline, or fill the raster: gdal_fillnodata.py IN OUT",
      on_map(at, map.frame));
}

/// Why a release is refused; empty if it is right.
std::string fault_of(const Layer& layer, const Terrain& base, const MapOfCase& map,
                     const std::optional<TerrainCrop>& crop) {
  const PlanRaster& t = layer.thickness;
  if (!find_pixel(t, [&](int column, int row) { return t.at(column, row) > 0; }))
    return "has no volume: its thickness is 0 everywhere";
  constexpr double drawn_side_by_side = 1.01;  // along a border drawn twice, slivers overlap
  const auto overlapping =
      find_pixel(t, [&](int column, int row) { return layer.covered.at(column, row) > drawn_side_by_side; });
  if (overlapping)
    return fmt::format("has polygons that overlap at {}; draw them side by side",
                       on_map(t.middle((*overlapping)[0], (*overlapping)[1]), map.frame));
  const auto beside = find_pixel(t, [&](int column, int row) {
    const Vec<2> at = t.middle(column, row);
    return t.at(column, row) > 0 && !map.ground->is_known(at[0], at[1]);
  });
  if (!beside) return fault_of_base(t, base, map);
  return fault_of_place(t.middle((*beside)[0], (*beside)[1]), map, crop);
}

/// The first place where two layers fill the same space, in the middle of a pixel whose neighbours they share, too: pixels
/// along a border that two releases have in common belong to both. Layers above one another may overlap by less than
/// half a particle, since their surfaces were drawn on different pixels.
std::optional<Vec<2>> overlap(const SurfaceLayer& a, const SurfaceLayer& b) {
  const double apart = std::max(a.thickness.pixel, b.thickness.pixel);
  const double deep = 0.5 * std::min(a.thickness.pixel, b.thickness.pixel);
  const auto has_both = [&](const Vec<2>& x) {
    const auto thickness_of = [&](const SurfaceLayer& layer) {
      const int column = layer.thickness.column_of(x[0]), row = layer.thickness.row_of(x[1]);
      return layer.thickness.has(column, row) ? layer.thickness.at(column, row) : 0;
    };
    const double of_a = thickness_of(a), of_b = thickness_of(b);
    if (!(of_a > 0 && of_b > 0)) return false;
    if (a.base == b.base) return true;
    const double under_a = a.base->at(x[0], x[1]).height, under_b = b.base->at(x[0], x[1]).height;
    return std::min(under_a + of_a, under_b + of_b) - std::max(under_a, under_b) > deep;
  };
  std::optional<Vec<2>> place;
  for_each_pixel(a.thickness, [&](int column, int row) {
    const Vec<2> x = a.thickness.middle(column, row);
    if (!place && has_both(x) && has_both(x + Vec<2>{apart, 0}) && has_both(x - Vec<2>{apart, 0}) &&
        has_both(x + Vec<2>{0, apart}) && has_both(x - Vec<2>{0, apart}))
      place = x;
  });
  return place;
}

/// Complains if another body lies on the same ground.
void check_apart(Section& s, const SurfaceLayer& layer, const Case& case_) {
  for (const BodySpec& other : case_.bodies)
    if (const auto* its = std::get_if<SurfaceLayer>(&other.region))
      if (const auto place = overlap(layer, *its))
        return s.complain(fmt::format(
            "overlaps the release of body `{}` at {}; of layers above one another the upper one needs a `bottom`",
            other.name, on_map(*place, case_.map->frame)));
}

/// Shows volume, area and mean thickness. A thickness that was measured has two readings, `normal` or vertical, with
/// volumes that differ by the cosine of the slope: both are shown, the one that is used first.
void note_size(Section& s, const SurfaceLayer& layer, const PlanRaster& covered, bool normal) {
  const PlanRaster& t = layer.thickness;
  const double pixel_area = t.pixel * t.pixel;
  double upright = 0, across = 0, other = 0, area = 0, slope = 0;
  for_each_pixel(t, [&](int column, int row) {
    if (!(t.at(column, row) > 0)) return;
    const Vec<2> at = t.middle(column, row);
    upright += t.at(column, row) * pixel_area;
    const double cosine = layer.base->at(at[0], at[1]).cosine(), covered_here = covered.at(column, row) * pixel_area;
    across += t.at(column, row) * cosine * pixel_area;
    other += t.at(column, row) * (normal ? cosine : 1 / cosine) * pixel_area;
    area += covered_here;
    slope += std::acos(std::min(cosine, 1.0)) * covered_here;
  });
  if (s.has("top")) {
    s.note("volume", fmt::format("{:.6g} m3", upright), "released: between the surfaces");
  } else {
    const char *used = normal ? "normal to the ground" : "vertical",
               *not_used = normal ? "vertical" : "normal to the ground";
    s.note("volume", fmt::format("{:.6g} m3", upright),
           fmt::format("released: thickness is {}, as `measured` states", used));
    s.note(normal ? "volume_if_vertical" : "volume_if_normal", fmt::format("{:.6g} m3", other),
           fmt::format("not used: the volume if the same thickness were {}", not_used));
  }
  s.note("area", fmt::format("{:.6g} m2", area), "in plan");
  s.note("mean_thickness",
         fmt::format("{:.3g} m vertical, {:.3g} m normal to the ground", upright / area, across / area),
         "of the release");
  s.note("mean_slope", fmt::format("{:.1f} deg", slope / area * 180 / std::numbers::pi), "of the ground under it");
}

}  // namespace

const Declaration& release_declaration() {
  static const Declaration d("a release",
                             {depends(polygons), optional(even_thickness), optional(attribute), optional(raster),
                              optional(top), optional(bottom), depends(unit), depends(measured)},
                             {"thickness", "attribute", "raster", "top"});
  return d;
}

Region read_release(Section& s, Case& case_, const std::string& folder, double spacing,
                    const std::optional<TerrainCrop>& crop) {
  const Box none{case_.domain.min, case_.domain.min};  // that nobody complains about
  if (!case_.map) {
    if (s.is_right()) s.complain("lies on a [terrain], and there is none; name the raster of its heights there");
    return none;
  }
  const Release release = read_source(s, folder, case_.cell, *case_.map);
  s.close();
  if (!s.is_right() || !(spacing > 0) || (!release.outlines && !release.raster)) return none;
  const Rectangle around = rectangle_around(release);
  const PlanRaster pixels = around.is_empty() ? PlanRaster{} : pixels_over(around, spacing);
  if (!around.is_empty() && pixels.values.empty()) {
    s.complain("needs too many particles; enlarge the `spacing` of the body");
    return none;
  }
  Layer upright = upright_layer(release, *release.base, pixels);
  if (const std::string fault = fault_of(upright, *release.base, *case_.map, crop); !fault.empty()) {
    s.complain(fault);
    return none;
  }
  const SurfaceLayer layer{release.base, std::move(upright.thickness)};
  check_apart(s, layer, case_);
  note_size(s, layer, upright.covered, release.normal);
  return layer;
}

}  // namespace talus
