#include "talus/mpm/start/plausibility.hpp"

#include <fmt/format.h>

#include <cmath>
#include <map>
#include <string>
#include <utility>

#include "talus/base/units.hpp"
#include "talus/case/check.hpp"
#include "talus/mpm/start/filling.hpp"

namespace talus {

namespace {

/// Usual range of a quantity for ground, grains and laboratory models.
struct Usual {
  std::string_view key, unit;
  double low, high;
};
constexpr Usual usual_of_materials[] = {
    {"rho_s", "kg/m3", 500, 10000},  // foamed clay to steel
    {"density", "kg/m3", 100, 10000},
    {"d", "m", 1e-6, 2},     // silt to boulders
    {"E", "Pa", 1e3, 1e12},  // gel to steel and above
};
constexpr Usual usual_friction{"friction", "1", 0, 2};            // 63 deg
constexpr Usual usual_gravity{"gravity", "m/s2", 0, 200 * 9.81};  // the largest geotechnical centrifuges

void doubt(std::vector<std::string>& doubts, const std::string& section, const Usual& usual, double value) {
  if (value >= usual.low && value <= usual.high) return;
  doubts.push_back(fmt::format("{}.{} = {} is unusual; usual values are {}.", section, usual.key,
                               with_unit(value, usual.unit),
                               in_words(Range::between(usual.low, usual.high), usual.unit)));
}

void doubt_material(std::vector<std::string>& doubts, const Material& material) {
  const std::string section = "material." + material.name;
  const auto doubt_value = [&](std::string_view key, double value) {
    for (const Usual& usual : usual_of_materials)
      if (usual.key == key) doubt(doubts, section, usual, value);
  };
  std::visit(
      [&](auto law) {
        for (const auto& p : law.parameters()) doubt_value(p.key, p.value(law));
      },
      material.law);
  if (material.density > 0) doubt_value("density", material.density);
}

void doubt_gravity(std::vector<std::string>& doubts, const Case& case_) {
  const Vec<3>& g = case_.gravity;
  doubt(doubts, "domain", usual_gravity, std::sqrt(dot(g, g)));
  if (const int up = case_.dim - 1; g[up] > 0)
    doubts.push_back(
        fmt::format("domain.gravity points upwards: its component along {} is {}. Write \"-{}\" for gravity "
                    "downwards.",
                    axis_names[up], with_unit(g[up], "m/s2"), with_unit(g[up], "m/s2")));
}

void doubt_friction(std::vector<std::string>& doubts, const std::string& section, const Wall& wall) {
  if (wall.kind == WallKind::friction) doubt(doubts, section, usual_friction, wall.friction);
}

void doubt_surfaces(std::vector<std::string>& doubts, const Case& case_) {
  for (int side = 0; side < 2 * case_.dim; ++side)
    doubt_friction(doubts, "domain.walls." + name_of_side(side), case_.walls[std::size_t(side)]);
  for (const Solid& solid : case_.solids) {
    const SectionPath path = section_of(solid);
    const std::string section = path.size() == 1 ? path[0] : path[0] + "." + path[1];
    doubt_friction(doubts, section + ".contact", solid.contact);
    for (const Wall& zone : solid.zones.surfaces) doubt_friction(doubts, section + ".contact", zone);
  }
}

/// Whether a support is at a place: a side of the domain, a solid, another body.
bool is_carried_at(const Vec<3>& x, const BodySpec& body, const Case& case_) {
  const int up = case_.dim - 1;
  if (x[up] < case_.domain.min[up]) return case_.walls[2 * std::size_t(up)].kind != WallKind::outflow;
  for (const Solid& solid : case_.solids)
    if (solid.near(x, solid.motion.at(0), case_.dim).distance < 0) return true;
  for (const BodySpec& other : case_.bodies) {
    if (&other == &body) continue;
    if (contains(std::holds_alternative<PointList>(other.region) ? bounding_box(other.region, case_.dim) : other.region,
                 x, case_.dim))
      return true;
  }
  return false;
}

/// Whether no column of a body has a support within a cell below it.
bool floats(const BodySpec& body, const Case& case_) {
  constexpr double most_points = 1e6;
  if (!(lattice_places(case_, body) <= most_points)) return false;
  const int up = case_.dim - 1;
  std::map<std::pair<long, long>, Vec<3>> lowest;  // lowest point of each column of cells
  for (const Vec<3>& x : fill(case_, body).points) {
    const std::pair<long, long> column{std::lround(x[0] / case_.cell),
                                       case_.dim == 3 ? std::lround(x[1] / case_.cell) : 0};
    const auto [at, is_new] = lowest.try_emplace(column, x);
    if (!is_new && x[up] < at->second[up]) at->second = x;
  }
  for (auto [column, x] : lowest) {
    x[up] -= case_.cell + body.spacing;
    if (is_carried_at(x, body, case_)) return false;
  }
  return true;
}

/// Mean thickness of a layer [m]; not of its outermost pixels, which it may cover in part, unless it has no others.
double mean_thickness(const PlanRaster& thickness) {
  double sum = 0, sum_inside = 0;
  std::size_t n = 0, n_inside = 0;
  const auto is_covered = [&](int column, int row) {
    return thickness.has_pixel(column, row) && thickness.at(column, row) > 0;
  };
  for (int row = 0; row < thickness.rows; ++row)
    for (int column = 0; column < thickness.columns; ++column) {
      if (!is_covered(column, row)) continue;
      sum += thickness.at(column, row);
      ++n;
      bool is_inside = true;
      for (int i = 0; i < 9; ++i) is_inside = is_inside && is_covered(column + i % 3 - 1, row + i / 3 - 1);
      if (!is_inside) continue;
      sum_inside += thickness.at(column, row);
      ++n_inside;
    }
  return n_inside > 0 ? sum_inside / double(n_inside) : n > 0 ? sum / double(n) : 0;
}

/// A layer thinner than half the particle spacing: its particles are flat plates, and maps show little of it.
void doubt_thin_layer(std::vector<std::string>& doubts, const BodySpec& body) {
  const auto* layer = std::get_if<SurfaceLayer>(&body.region);
  if (!layer) return;
  const double mean = mean_thickness(layer->thickness);
  if (mean == 0 || mean >= (1 - 1e-9) * 0.5 * body.spacing) return;
  doubts.push_back(fmt::format(
      "body.{}.release is {} thick on average (vertical), less than half the `spacing` of its particles, {}: neither "
      "thickness nor speed is resolved. Use a `spacing` of at most half the thickness, and a `cell` of twice that.",
      body.name, with_unit(std::stod(fmt::format("{:.3g}", mean)), "m"), with_unit(body.spacing, "m")));
}

}  // namespace

std::vector<std::string> doubts_about(const Case& case_) {
  std::vector<std::string> doubts;
  doubt_gravity(doubts, case_);
  doubt_surfaces(doubts, case_);
  for (const Material& material : case_.materials) doubt_material(doubts, material);
  for (const BodySpec& body : case_.bodies) doubt_thin_layer(doubts, body);
  for (const BodySpec& body : case_.bodies)
    if (body.initial_stress == InitialStress::k0 && floats(body, case_))
      doubts.push_back(
          fmt::format("body.{}.initial_stress = \"k0\" is the stress of ground at rest, and nothing is below "
                      "the body. Write \"zero\" for a body that falls.",
                      body.name));
  return doubts;
}

}  // namespace talus
