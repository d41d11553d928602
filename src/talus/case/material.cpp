#include "talus/case/material.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <bit>

namespace talus {

namespace {

/// Whether two laws are the same, with the same parameters, bit by bit, and the same options.
bool are_same(const AnyLaw& a, const AnyLaw& b) {
  if (a.index() != b.index()) return false;
  return std::visit(
      [&]<class Law>(Law x) {
        Law y = std::get<Law>(b);
        const auto bits = [](double number) { return std::bit_cast<std::uint64_t>(number); };
        const auto parameters = Law::parameters();
        const auto options = Law::options();
        return std::all_of(parameters.begin(), parameters.end(),
                           [&](const auto& p) { return bits(p.value(x)) == bits(p.value(y)); }) &&
               std::all_of(options.begin(), options.end(), [&](const auto& o) { return o.get(x) == o.get(y); });
      },
      a);
}

}  // namespace

bool Material::operator==(const Material& other) const {
  return name == other.name && density == other.density && are_same(law, other.law);
}

std::string name_of(const AnyLaw& law) {
  return std::visit([](const auto& l) { return std::string(l.name); }, law);
}

std::optional<Range> void_ratios_of(const AnyLaw& law) {
  return std::visit(
      []<class Law>(const Law&) -> std::optional<Range> {
        if constexpr (HasVoidRatio<Law>) return Law::void_ratios;
        return std::nullopt;
      },
      law);
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

bool has_lasting_contacts(const AnyLaw& law) {
  return std::visit([]<class Law>(const Law&) { return HasLastingContacts<Law>; }, law);
}

bool scales_stiffness(const AnyLaw& law) {
  return std::visit([]<class Law>(const Law&) { return ScalesStiffness<Law>; }, law);
}

bool remembers_collisional_stress(const AnyLaw& law) {
  if (const auto* alone = std::get_if<MuI>(&law)) return alone->form != CollisionalForm::total;
  return std::holds_alternative<GranularWithHistory>(law);
}

bool needs_density(const AnyLaw& law) {
  return std::visit(
      []<class Law>(const Law& l) {
        return !requires { l.grain_density(); };
      },
      law);
}

bool is_for_element_tests_only(const AnyLaw& law) {
  return std::visit(
      [](const auto& l) {
        return requires { l.for_element_tests_only; };
      },
      law);
}

std::optional<double> critical_friction_of(const AnyLaw& law) {
  return std::visit(
      []<class Law>(const Law& l) -> std::optional<double> {
        if constexpr (HasCriticalFriction<Law>) return l.critical_friction();
        return std::nullopt;
      },
      law);
}

FrictionRise friction_rise_of(const AnyLaw& law) {
  return std::visit(
      [](const auto& l) -> FrictionRise {
        if constexpr (requires { l.friction_rise(); }) return l.friction_rise();
        return {};
      },
      law);
}

double grain_diameter_of(const AnyLaw& law) {
  return std::visit(
      [](const auto& l) {
        if constexpr (requires { l.grain_diameter(); }) return l.grain_diameter();
        return 0.0;
      },
      law);
}

std::vector<Quantity> quantities_of(const AnyLaw& law) {
  return std::visit(
      [](const auto& l) {
        const auto table = l.quantities();
        return std::vector<Quantity>(table.begin(), table.end());
      },
      law);
}

bool has_quantity(const AnyLaw& law, std::string_view name) {
  const std::vector<Quantity> all = quantities_of(law);
  return std::any_of(all.begin(), all.end(), [&](const Quantity& q) { return q.name == name; });
}

}  // namespace talus
