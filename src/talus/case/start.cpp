#include "talus/case/start.hpp"

#include <fmt/format.h>

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

InitialState initial_state(const Case& what, const BodySpec& body, double depth) {
  const Material& material = what.materials[body.material];
  const int up = what.dim - 1;
  InitialState initial;
  initial.void_ratio = body.void_ratio.value_or(0);
  if (body.initial_stress != InitialStress::k0) return initial;
  const double weight = -bulk_density(material, body) * what.gravity[up];  // per volume, downwards
  if (!(weight > 0)) return initial;
  const double vertical = weight * depth;
  const double horizontal =
      std::visit([](const auto& law) { return law.earth_pressure_at_rest(); }, material.law) * vertical;
  initial.stress = {-horizontal, -horizontal, -horizontal, 0, 0, 0};
  initial.stress[up] = -vertical;
  return initial;
}

std::variant<double, std::string> wave_speed_at_rest(const Case& what, const BodySpec& body, double depth) {
  const Material& material = what.materials[body.material];
  const InitialState initial = initial_state(what, body, depth);
  const AnyLaw scaled = with_scaled_stiffness(material.law, what.numerics.stiffness_factor);
  return std::visit(
      [&]<class Law>(const Law& law) -> std::variant<double, std::string> {
        auto state = law.at_rest(initial);
        if (const auto* reason = std::get_if<std::string>(&state)) return *reason;
        const Motion<double> none{SymTensor<double>::zero(), SymTensor<double>::zero(), 1};
        const double stiffness =
            law.update(std::get<typename Law::template State<double>>(state), none, what.numerics.integration)
                .stiffness;
        return std::sqrt(stiffness / bulk_density(material, body));
      },
      scaled);
}

std::string fault_of_void_ratio(const AnyLaw& law, double void_ratio) {
  return std::visit(
      [&](const auto& grains) -> std::string {
        if constexpr (requires { grains.closest_packing(); })
          if (1 / (1 + void_ratio) >= grains.closest_packing())
            return fmt::format("is denser than random close packing: it must exceed 1/Phi_c - 1 = {:.4f} (Eq. 15)",
                               1 / grains.closest_packing() - 1);
        return "";
      },
      law);
}

}  // namespace talus
