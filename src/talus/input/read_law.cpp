#include "talus/input/read_law.hpp"

#include <fmt/format.h>

#include <limits>

#include "talus/case/defaults.hpp"
#include "talus/case/material.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

/// The laws that a user may name.
const std::vector<Choice>& named_laws() {
  static const std::vector<Choice> laws = [] {
    std::vector<Choice> named;
    Laws::for_each([&]<class Law>() {
      if (is_named<Law>) named.push_back({Law::name, Law::meaning});
    });
    return named;
  }();
  return laws;
}
Option law_option() { return {"law", "constitutive law", named_laws()}; }

template <class Law>
AnyLaw read_parameters(Section& section, Preset preset, const std::set<std::string>& given, bool confined) {
  Law law{};
  for (const auto& p : Law::parameters()) {
    const bool elsewhere = given.contains(std::string(p.key));
    if (elsewhere && section.has(p.key)) section.complain(p.key, "is given twice: it follows from a formula");
    p.value(law) = elsewhere ? std::numeric_limits<double>::quiet_NaN() : section.number(p);
  }
  for (const auto& o : Law::options()) o.set(law, section.choice(o, default_choice(o, preset, confined)));
  if constexpr (requires { law.fault(); })
    if (const std::optional<Fault> fault = law.fault(); fault && given.empty())
      section.complain(fault->key, fault->why);
  law.prepare();
  return settled(law);
}

}  // namespace

std::vector<Entry> entries_of_laws() {
  std::vector<Entry> all = {required(law_option())};
  Laws::for_each([&]<class Law>() {
    if (!is_named<Law>) return;
    for (const auto& p : Law::parameters())
      all.push_back(required(static_cast<const Parameter&>(p)).with("law", {std::string(Law::name)}));
    for (const auto& o : Law::options())
      all.push_back(optional(static_cast<const Option&>(o)).with("law", {std::string(Law::name)}));
  });
  return all;
}

const Declaration& material_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> entries = entries_of_laws();
    std::vector<std::string> laws_of_density;
    Laws::for_each([&]<class Law>() {
      const AnyLaw law = Law{};
      if (is_named<Law> && needs_density(law) && !is_for_element_tests_only(law))
        laws_of_density.push_back(name_of(law));
    });
    entries.push_back(required(keys::density).with("law", laws_of_density));
    return Declaration("a material", std::move(entries));
  }();
  return d;
}

AnyLaw read_law(Section& section, Preset preset, const std::set<std::string>& given, bool confined) {
  const std::vector<Choice>& laws = named_laws();
  const std::optional<int> chosen = section.deciding_choice(law_option());
  AnyLaw result;
  if (!chosen) section.give_up();
  Laws::for_each([&]<class Law>() {
    if (chosen && is_named<Law> && Law::name == laws[std::size_t(*chosen)].word)
      result = read_parameters<Law>(section, preset, given, confined);
  });
  return result;
}

void read_materials(Section& root, Preset preset, Case& case_) {
  for (auto& [name, section] : root.named_sections(keys::materials)) {
    Material material{name, read_law(section, preset), 0};
    if (is_for_element_tests_only(material.law))
      section.complain("law", "is for element tests only; it has no meaning in a flow");
    else if (needs_density(material.law))
      material.density = section.number(keys::density);
    section.close(fmt::format("law `{}`", name_of(material.law)));
    case_.materials.push_back(std::move(material));
  }
}

}  // namespace talus
