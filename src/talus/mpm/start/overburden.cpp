#include "talus/mpm/start/overburden.hpp"

#include <algorithm>
#include <cmath>

namespace talus {

double bulk_density(const Material& material, const BodySpec& body) {
  return std::visit(
      [&]<class Law>(const Law& law) {
        if constexpr (requires { law.grain_density(); }) {
          static_assert(HasVoidRatio<Law>,
                        "a law that knows the density of its grains also says which `void_ratios` it takes");
          return law.grain_density() / (1 + *body.void_ratio);
        } else {
          return material.density;
        }
      },
      material.law);
}

namespace {

/// Gradient of the thickness of a layer along an axis: least-squares line over two cells on either side, which smooths
/// steps between the pixels of a map. 0 where the layer ends within this distance, because an edge is not a slope.
PlanRaster thickening(const PlanRaster& thickness, double cell, int axis) {
  PlanRaster growth = thickness;
  const int n = std::max(1, int(std::lround(2 * cell / thickness.pixel)));
  for (int row = 0; row < thickness.rows; ++row)
    for (int column = 0; column < thickness.columns; ++column) {
      double moment = 0, squares = 0;
      bool reaches = true;
      for (int i = -n; i <= n && reaches; ++i) {
        const int there = axis == 0 ? column + i : column, up = axis == 0 ? row : row + i;
        reaches = thickness.has(there, up) && thickness.at(there, up) > 0;
        if (!reaches) break;
        moment += i * thickness.pixel * thickness.at(there, up);
        squares += i * thickness.pixel * i * thickness.pixel;
      }
      growth.at(column, row) = reaches ? moment / squares : 0;
    }
  return growth;
}

}  // namespace

Overburden::Overburden(const Case& case_) : dim_(case_.dim) {
  for (const BodySpec& body : case_.bodies) {
    const double weight = -bulk_density(case_.materials[body.material], body) * case_.gravity[dim_ - 1];
    if (body.initial_stress != InitialStress::k0 || !(weight > 0)) continue;
    Layer layer{&body.region, weight, {}};
    if (const auto* list = std::get_if<PointList>(&body.region)) {
      for (const double v : list->volumes) layer.columns.width = std::max(layer.columns.width, std::pow(v, 1.0 / dim_));
      for (std::size_t i = 0; i < list->places.size(); ++i)
        layer.columns.points[layer.columns.column_of(list->places[i][0], across(list->places[i]))].push_back(i);
    }
    if (const auto* on_ground = std::get_if<SurfaceLayer>(&body.region)) {
      layer.thickening_x = thickening(on_ground->thickness, case_.cell, 0);
      layer.thickening_y = thickening(on_ground->thickness, case_.cell, 1);
    }
    layers_.push_back(std::move(layer));
  }
}

Load Overburden::on(const Vec<3>& x, double width) const {
  Load load;
  for (const Layer& layer : layers_) {
    const auto* list = std::get_if<PointList>(layer.region);
    const double depth = list ? thickness(*list, layer.columns, x, width) : length_above(*layer.region, x, dim_);
    load.depth += depth;
    load.stress += layer.weight * depth;
  }
  return load;
}

double Overburden::thickness(const PointList& list, const Columns& columns, const Vec<3>& x, double width) const {
  const int up = dim_ - 1;
  const double reach = 0.5 * (width + columns.width);
  const auto low = columns.column_of(x[0] - reach, across(x) - reach);
  const auto high = columns.column_of(x[0] + reach, across(x) + reach);
  double volume = 0;
  for (int j = low[1]; j <= high[1]; ++j)
    for (int i = low[0]; i <= high[0]; ++i) {
      const auto column = columns.points.find({i, j});
      if (column == columns.points.end()) continue;
      for (const std::size_t k : column->second) {
        const double edge = std::pow(list.volumes[k], 1.0 / dim_);
        const Vec<3>& at = list.places[k];
        double part = std::clamp(at[up] + 0.5 * edge - x[up], 0.0, edge);
        for (int a = 0; a < up; ++a)
          part *= std::max(
              0.0, std::min(at[a] + 0.5 * edge, x[a] + 0.5 * width) - std::max(at[a] - 0.5 * edge, x[a] - 0.5 * width));
        volume += part;
      }
    }
  return volume / std::pow(width, up);
}

Vec<2> Overburden::slope_above(const BodySpec& body, const Vec<3>& x) const {
  Vec<2> slope{};
  if (!std::holds_alternative<SurfaceLayer>(body.region)) return slope;
  double highest = -INFINITY;
  for (const Layer& layer : layers_) {
    const auto* on_ground = std::get_if<SurfaceLayer>(layer.region);
    if (!on_ground) continue;
    const PlanRaster& t = on_ground->thickness;
    const int column = t.column_of(x[0]), row = t.row_of(x[1]);
    if (!t.has(column, row) || !(t.at(column, row) > 0)) continue;
    const TerrainPlace base = on_ground->base->at(x[0], x[1]);
    const double surface = base.height + t.at(column, row);
    if (surface <= highest) continue;
    highest = surface;
    slope = {base.dx + layer.thickening_x.at(column, row), base.dy + layer.thickening_y.at(column, row)};
  }
  return slope;
}

InitialState initial_state(const Case& case_, const BodySpec& body, double load, const Vec<2>& slope) {
  InitialState initial;
  initial.void_ratio = body.void_ratio.value_or(0);
  if (body.initial_stress == InitialStress::given) initial.stress = body.given_stress;
  if (body.initial_stress != InitialStress::k0) return initial;
  const double horizontal =
      std::visit([](const auto& law) { return law.earth_pressure_at_rest(); }, case_.materials[body.material].law) *
      load;
  const int up = case_.dim - 1;
  initial.stress = {-horizontal, -horizontal, -horizontal, 0, 0, 0};
  initial.stress[up] = -load;
  for (int a = 0; a < up; ++a) {
    const int shear = case_.dim == 2 ? 3 : a == 0 ? 5 : 4;  // xy; zx and yz
    initial.stress[shear] = load * case_.gravity[a] / -case_.gravity[up];
    if (up == 2) initial.stress[shear] -= horizontal * slope[a];
  }
  initial.stress[up] -= horizontal * dot(slope, slope);
  return initial;
}

std::variant<double, std::string> wave_speed_at_rest(const Case& case_, const BodySpec& body, double load) {
  const Material& material = case_.materials[body.material];
  const InitialState initial = initial_state(case_, body, load);
  const AnyLaw scaled = with_scaled_stiffness(material.law, case_.numerics.stiffness_factor);
  return std::visit(
      [&]<class Law>(const Law& law) -> std::variant<double, std::string> {
        auto state = law.at_rest(initial);
        if (const auto* reason = std::get_if<std::string>(&state)) return *reason;
        const Motion<double> none{SymTensor<double>::zero(), SymTensor<double>::zero(), 1};
        const double stiffness =
            law.update(std::get<typename Law::template State<double>>(state), none, case_.numerics.integration)
                .stiffness;
        return std::sqrt(stiffness / bulk_density(material, body));
      },
      scaled);
}

}  // namespace talus
