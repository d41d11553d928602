#include "talus/input/read_law.hpp"

#include <algorithm>

namespace talus {

namespace {

/// The range of void ratios of a law that has one.
template <class Law>
std::optional<Range> void_ratios() {
  if constexpr (HasVoidRatio<Law>) return Law::void_ratios;
  return std::nullopt;
}

}  // namespace

AnyLaw read_law(Section& section) {
  std::vector<Choice> laws;
  Laws::for_each([&]<class Law>() {
    if (is_named<Law>) laws.push_back({Law::name, Law::meaning});
  });
  const int chosen = section.required_choice({"law", "constitutive law", laws});
  AnyLaw result;
  Laws::for_each([&]<class Law>() {
    if (!is_named<Law> || Law::name != laws[chosen].word) return;
    Law law{};
    for (const auto& p : Law::parameters()) p.value(law) = section.number(p);
    for (const auto& o : Law::options()) o.set(law, section.choice(o));
    if constexpr (requires { law.fault(); })
      if (const std::optional<Fault> fault = law.fault()) section.complain(fault->key, fault->why);
    law.prepare();
    result = settled(law);
  });
  return result;
}

std::string name_of(const AnyLaw& law) {
  return std::visit([](const auto& l) { return std::string(l.name); }, law);
}

std::optional<Range> void_ratios_of(const AnyLaw& law) {
  return std::visit([]<class Law>(const Law&) { return void_ratios<Law>(); }, law);
}

bool has_lasting_contacts(const AnyLaw& law) {
  return std::visit([]<class Law>(const Law&) { return HasLastingContacts<Law>; }, law);
}

bool scales_stiffness(const AnyLaw& law) {
  return std::visit([]<class Law>(const Law&) { return ScalesStiffness<Law>; }, law);
}

bool tells(const AnyLaw& law, std::string_view quantity) {
  return std::visit(
      [&]<class Law>(const Law&) {
        const auto told = Law::quantities();
        return std::any_of(told.begin(), told.end(), [&](const Quantity& q) { return q.name == quantity; });
      },
      law);
}

}  // namespace talus
