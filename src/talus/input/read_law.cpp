#include "talus/input/read_law.hpp"

#include <fmt/format.h>

#include "talus/case/defaults.hpp"
#include "talus/case/keys.hpp"
#include "talus/case/material.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

template <class Law>
AnyLaw read_parameters(Section& section, Preset preset) {
  Law law{};
  for (const auto& p : Law::parameters()) p.value(law) = section.number(p);
  for (const auto& o : Law::options()) o.set(law, section.choice(o, default_choice(o, preset)));
  if constexpr (requires { law.fault(); })
    if (const std::optional<Fault> fault = law.fault()) section.complain(fault->key, fault->why);
  law.prepare();
  return settled(law);
}

}  // namespace

AnyLaw read_law(Section& section, Preset preset) {
  std::vector<Choice> laws;
  Laws::for_each([&]<class Law>() {
    if (is_named<Law>) laws.push_back({Law::name, Law::meaning});
  });
  const int chosen = section.required_choice({"law", "constitutive law", laws});
  AnyLaw result;
  Laws::for_each([&]<class Law>() {
    if (is_named<Law> && Law::name == laws[std::size_t(chosen)].word) result = read_parameters<Law>(section, preset);
  });
  return result;
}

void read_materials(Section& root, Preset preset, Case& case_) {
  for (auto& [name, section] : root.named_sections("material", "what bodies are made of")) {
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
