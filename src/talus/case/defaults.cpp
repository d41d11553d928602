#include "talus/case/defaults.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "talus/case/material.hpp"
#include "talus/law/registry.hpp"

namespace talus {

Numerics numerics_of(Preset preset) {
  Numerics n;
  n.preset = preset;
  if (preset == Preset::paper) {
    n.shape_function = ShapeFunction::linear;
    n.transfer = Transfer::flip;
    n.integration.scheme = Integrator::forward_euler;
    n.average_pressure = averages_pressure(preset, false);
    n.particle_shifting = false;
    n.particle_splitting = Splitting::none;
    n.dt = 1e-6;  // as in the paper
  }
  return n;
}

bool averages_pressure(Preset preset, bool f_bar) { return !f_bar && preset != Preset::paper; }

/// With 0.2 pressure in flow is still noisy, with 0.4 it is not, and larger values shorten the steps: table in
/// docs/numerics.md.
Default default_bulk_viscosity(Preset preset, Order order) {
  if (preset == Preset::paper) return {0, "as in the paper"};
  if (order == Order::musl) return {0, "with order = \"musl\""};
  return {0.4, "reduces pressure noise in flow"};
}

double bulk_viscosity_of(const Numerics& numerics) {
  return numerics.bulk_viscosity.value_or(default_bulk_viscosity(numerics.preset, numerics.order).value);
}

int default_choice(const Option& option, Preset preset, bool confined) {
  std::string_view word;
  if (preset == Preset::paper && option.key == "collisional_form") word = "rate";
  if (confined && option.key == "separated_grains") word = "colliding";
  for (std::size_t i = 0; i < option.choices.size(); ++i)
    if (option.choices[i].word == word) return int(i);
  return 0;
}

namespace {

/// Stability limit of a single particle under compression along all axes at the worst position: dt < 2
/// sqrt(2/3)/sqrt(S) h/c with Poisson's ratio 0.2, where S = max sum N'^2/N: 6 for quadratic, 3.14 for cubic splines.
/// uGIMP has 2/l + 1/(1 - l) with a half-width of l cells: 9.3 with two particles per cell and axis; for l = 0 it is
/// the hat function. For hat functions S has no bound, and runs fail at 1: a particle that has just entered a cell acts
/// on nodes with almost no mass (docs/performance.md, docs/numerics.md).
Default cfl_of_single_particles(ShapeFunction shape) {
  switch (shape) {
    case ShapeFunction::quadratic: return {0.65, "for quadratic shape functions"};
    case ShapeFunction::linear: return {0.5, "for linear shape functions"};
    case ShapeFunction::cubic: return {0.9, "for cubic shape functions"};
    case ShapeFunction::ugimp: return {0.5, "for uGIMP"};
  }
  return {0.5, ""};
}

bool stiffens_from_nothing(const Material& material) {
  return std::visit([](const auto& law) { return StiffensFromNothing<std::decay_t<decltype(law)>>; }, material.law);
}

}  // namespace

/// A particle that is alone has no stress, so where stiffness vanishes with it, it bounds no step. Cells with two particles
/// along each axis, in a lattice or at random, are stable below 1.06 with quadratic splines and bulk viscosity
/// (docs/performance.md).
Default default_cfl(const Case& case_) {
  const std::vector<Material>& materials = case_.materials;
  if (case_.numerics.shape_function == ShapeFunction::quadratic && !materials.empty() &&
      std::all_of(materials.begin(), materials.end(), stiffens_from_nothing))
    return {0.9, "for quadratic shape functions and stiffness that vanishes with the stress"};
  return cfl_of_single_particles(case_.numerics.shape_function);
}

double cfl_of(const Numerics& numerics) {
  return numerics.cfl.value_or(cfl_of_single_particles(numerics.shape_function).value);
}

namespace {

/// Time of free fall over half a height H, sqrt(H/g) [s]; 0 without gravity.
double time_of_fall(double height, const Vec<3>& gravity) {
  const double g = std::sqrt(dot(gravity, gravity));
  return g > 0 && height > 0 ? std::sqrt(height / g) : 0;
}

/// Largest vertical thickness of the layers on a terrain [m]; 0 if a body is not a layer.
double thickness_of_layers(const Case& case_) {
  double thickness = 0;
  for (const BodySpec& b : case_.bodies) {
    const auto* layer = std::get_if<SurfaceLayer>(&b.region);
    if (!layer) return 0;
    for (const double t : layer->thickness.values) thickness = std::max(thickness, std::isnan(t) ? 0 : t);
  }
  return thickness;
}

}  // namespace

double time_of_fall(const Case& case_) {
  double low = std::numeric_limits<double>::infinity(), high = -low;
  for (const BodySpec& b : case_.bodies) {
    const Box box = bounding_box(b.region, case_.dim);
    low = std::min(low, box.min[case_.dim - 1]);
    high = std::max(high, box.max[case_.dim - 1]);
  }
  return time_of_fall(high - low, case_.gravity);
}

std::optional<Default> default_tau(const Case& case_) {
  constexpr double share = 0.08;
  if (const double fall = time_of_fall(thickness_of_layers(case_), case_.gravity); fall > 0)
    return Default{share * fall, "0.08 sqrt(H/g), with the largest thickness H of what lies on the ground"};
  if (const double fall = time_of_fall(case_); fall > 0)
    return Default{share * fall, "0.08 sqrt(H/g), with the height H of all bodies"};
  return std::nullopt;
}

bool separates_from_wall(WallKind kind) { return kind == WallKind::friction || kind == WallKind::rough; }
bool separates_from_solid(WallKind kind) { return separates_from_wall(kind) || kind == WallKind::slip; }

namespace {

/// Material whose friction `rough` surfaces have: the first with a critical friction; null if there is none.
const Material* material_of_bed(const Case& case_) {
  for (const Material& m : case_.materials)
    if (critical_friction_of(m.law).value_or(0) != 0) return &m;
  return nullptr;
}

}  // namespace

double rough_friction(const Case& case_) {
  const Material* bed = material_of_bed(case_);
  return bed ? *critical_friction_of(bed->law) : 0;
}

FrictionRise rough_friction_rise(const Case& case_) {
  const Material* bed = material_of_bed(case_);
  return bed ? friction_rise_of(bed->law) : FrictionRise{};
}

Default default_snapshots(const Case& case_) { return {case_.end / 50, "a fiftieth of the run"}; }
Default default_history(const Case& case_) { return {case_.end / 500, "a five-hundredth of the run"}; }

Default default_peak_force_time(const Case& case_) {
  constexpr double share = 0.1;
  if (const double fall = time_of_fall(thickness_of_layers(case_), case_.gravity); fall > 0)
    return {std::min(case_.end, share * fall),
            "0.1 sqrt(H/g), with the largest thickness H of what lies on the ground"};
  if (const double fall = time_of_fall(case_); fall > 0)
    return {std::min(case_.end, share * fall), "0.1 sqrt(H/g), with the height H of all bodies"};
  return {case_.end / 500, "a five-hundredth of the run"};
}

double largest_particle(const BodySpec& body, int dim) {
  double largest = body.spacing;
  if (const auto* list = std::get_if<PointList>(&body.region))
    for (double v : list->volumes) largest = std::max(largest, width_at_start(body, v, dim));
  return largest;
}

Default default_front_thickness(const Case& case_) {
  double grain = 0, particle = 0;
  for (const BodySpec& b : case_.bodies) {
    particle = std::max(particle, largest_particle(b, case_.dim));
    if (b.material >= 0) grain = std::max(grain, grain_diameter_of(case_.materials[std::size_t(b.material)].law));
  }
  if (grain > 0) return {grain, "a grain"};
  return {particle, "edge of a particle at the start"};
}

Default default_map_interval(const Case& case_) {
  const Terrain& ground = *case_.map->ground;
  const double fall = ground.highest() - ground.lowest(), g = std::sqrt(dot(case_.gravity, case_.gravity));
  const double speed = std::sqrt(2 * g * fall);
  const double pixel = case_.output.maps.pixel.value_or(ground.heights().pixel);
  if (!(speed > 0)) return {case_.end / 1000, "a thousandth of the run"};
  return {std::max(pixel / speed, case_.end / 10000),
          "time in which material that has fallen from the highest to the lowest place crosses a pixel"};
}

Default default_least_thickness(const Case& case_) {
  double widest = 0;
  for (const BodySpec& b : case_.bodies) widest = std::max(widest, largest_particle(b, case_.dim));
  return {widest / 4, "a quarter of a particle at the start"};
}

Default default_map_pixel(const Case& case_) { return {case_.map->ground->heights().pixel, "that of the terrain"}; }

Default default_map_frames(const Case& case_) {
  if (case_.stop_below > 0)
    return {case_.end / 60, "a sixtieth of the run, which may come to rest long before its end"};
  return {case_.end / 40, "a fortieth of the run"};
}

std::vector<double> default_pictures(const Case& case_) {
  std::vector<double> instants;
  for (int i = 0; i <= 5; ++i) instants.push_back(case_.end * i / 5);
  return instants;
}

std::vector<std::string_view> known_fields(const Case& case_) {
  std::vector<std::string_view> known;
  for (const Quantity& q : common_quantities) known.push_back(q.name);
  for (const Material& m : case_.materials)
    for (const Quantity& q : quantities_of(m.law)) known.push_back(q.name);
  return known;
}

std::vector<std::string> default_fields(const Case& case_) {
  std::vector<std::string_view> usual = {
      "velocity", "body", "frictional_stress", "collisional_stress", "stress", "p", "q", "p_f", "void_ratio",
      "kappa",    "I",    "viscosity",         "separated"};
  const bool splits = case_.numerics.particle_splitting != Splitting::none &&
                      std::ranges::any_of(case_.materials, [](const Material& m) { return !keeps_neighbours(m.law); });
  if (has_outflow(case_) || splits) usual.push_back("id");
  if (splits) usual.push_back("ancestor");
  const std::vector<std::string_view> known = known_fields(case_);
  std::vector<std::string> fields;
  for (std::string_view field : usual)
    if (std::find(known.begin(), known.end(), field) != known.end()) fields.emplace_back(field);
  return fields;
}

}  // namespace talus
