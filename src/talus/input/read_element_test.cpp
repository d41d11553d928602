#include <fmt/format.h>

#include <algorithm>
#include <filesystem>

#include "talus/case/material.hpp"
#include "talus/input/read_law.hpp"
#include "talus/input/segments.hpp"

namespace talus {

namespace {

/// A component of a stress, compression-positive.
constexpr Parameter component_of_stress(int i) {
  return {component_names[i], "Pa", stresses, "component of the stress, compression-positive"};
}
/// All components; the first `n_required` of them must be there.
Declaration declaration_of_stress(int n_required) {
  std::vector<Entry> components;
  for (int i = 0; i < 6; ++i)
    components.push_back(i < n_required ? required(component_of_stress(i)) : optional(component_of_stress(i)));
  return {"a stress", std::move(components)};
}
const Declaration& present_stress_declaration() {
  static const Declaration d = declaration_of_stress(3);
  return d;
}
const Declaration& collisional_stress_declaration() {
  static const Declaration d = declaration_of_stress(0);
  return d;
}

constexpr Parameter isotropic_pressure{"pressure", "Pa", pressures, "isotropic pressure"},
    pore_pressure{"pore_pressure", "Pa", stresses, "pore pressure before the test; the stress of the law is effective"},
    background_pressure{"background_pressure", "Pa", pressures, "constant pressure of contacts that are not modelled"},
    kappa{"kappa", "1", Range::not_negative(),
          "accumulated plastic deviatoric strain; without it, the least that carries the stress"};
constexpr Parameter void_ratio(const Range& of_law) { return {"void_ratio", "1", of_law, "void ratio"}; }
constexpr Table stress_at_start{"stress", "stress of enduring contacts, compression-positive",
                                present_stress_declaration},
    collisional_stress{"collisional_stress", "stress of collisions at the start, compression-positive",
                       collisional_stress_declaration};

const Declaration& initial_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> all = {depends(isotropic_pressure), optional(stress_at_start), depends(background_pressure),
                              optional(pore_pressure),     optional(kappa),           optional(collisional_stress)};
    Laws::for_each([&]<class Law>() {
      if constexpr (HasVoidRatio<Law>) all.push_back(depends(void_ratio(Law::void_ratios)));
    });
    return Declaration("[initial]", std::move(all));
  }();
  return d;
}

constexpr Option integrator_of_test{"integrator", "how the frictional stress is integrated", integrator_choices};
constexpr Parameter tolerance{"tolerance", "1", Range::between(1e-12, 0.1),
                              "relative error of the stress in a substep"};
const Declaration& driver_declaration() {
  static const Declaration d("[driver]", {optional(integrator_of_test), optional(tolerance)});
  return d;
}

const Declaration& law_declaration() {
  static const Declaration d("a material", entries_of_laws());
  return d;
}

constexpr Text title_of_test{"title", "what the test is, in one line", 200};
constexpr Table material_table{"material", "the law and its parameters", law_declaration},
    initial{"initial", "the state before the test", initial_declaration},
    driver{"driver", "how the test is integrated", driver_declaration};
constexpr ListOfTables segments{{"segment", "the loading path, segment after segment", segment_declaration}};

/// A table of components, compression-positive; the first `n_required` of them must be there.
SymTensor<double> read_stress(Section& s, const Table& table, int n_required) {
  Section components = s.section(table);
  SymTensor<double> given = SymTensor<double>::zero();
  for (int i = 0; i < 6; ++i)
    given[i] =
        i < n_required ? components.number(component_of_stress(i)) : components.number(component_of_stress(i), 0);
  components.close();
  return opposite_sign(given);
}

/// The stress that the test starts from, of a law that carries one at rest.
SymTensor<double> read_initial_stress(Section& s) {
  if (!s.has("stress")) return opposite_sign(SymTensor<double>::isotropic(s.number(isotropic_pressure)));
  if (s.has("pressure")) s.complain("pressure", "and `stress` exclude each other");
  return read_stress(s, stress_at_start, 3);
}

InitialState read_initial(Section& root, ElementTest& test) {
  Section s = root.section(initial);
  const AnyLaw& law = test.law;
  InitialState state;
  if (has_lasting_contacts(law))
    state.stress = read_initial_stress(s);
  else
    state.background_pressure = s.number(background_pressure);
  test.pore_pressure = s.number(pore_pressure, 0);
  if (const std::optional<Range> range = void_ratios_of(law)) {
    state.void_ratio = s.number(void_ratio(*range));
    if (const std::string why = fault_of_void_ratio(law, state.void_ratio); !why.empty()) s.complain("void_ratio", why);
  }
  if (has_quantity(law, "kappa")) state.kappa = s.optional_number(kappa);
  if (s.has("collisional_stress")) {
    state.collisional_stress = read_stress(s, collisional_stress, 0);
    if (!remembers_collisional_stress(law))
      s.complain(
          "collisional_stress",
          "follows from the strain rate in this law; collisional_form = \"rate\" or \"incremental\" remembers it");
  }
  s.close();
  return state;
}

void read_driver(Section& root, ElementTest& test) {
  Section s = root.optional_section(driver);
  test.integration.scheme = Integrator(s.choice(integrator_of_test, int(test.integration.scheme)));
  test.integration.tolerance = s.number(tolerance, test.integration.tolerance);
  test.tolerance = test.integration.tolerance;
  s.close();
}

}  // namespace

const Declaration& element_test_declaration() {
  static const Declaration d("an element test", {required(title_of_test), required(material_table), required(initial),
                                                 optional(driver), required(segments)});
  return d;
}

/// The loading path, before the rest: it decides on a default of the law. Its settings are listed last, as in files.
std::vector<Segment> read_path(Document& document, Section& root, const std::string& folder, auto read_rest) {
  std::vector<Segment> path;
  const auto n_before = std::ptrdiff_t(document.understood().size());
  bool any_named = false;
  for (Section& s : root.list_of_sections(segments)) {
    const std::size_t n = path.size();
    add_segments(s, folder, path);
    if (any_named || !s.has("test")) continue;
    any_named = true;  // what comes before the first test by name is seen along its axis
    Laboratory view = path.back().laboratory;
    view.undrained = false;
    for (std::size_t i = 0; i < n; ++i) path[i].laboratory = view;
  }
  const auto n_path = std::ptrdiff_t(document.understood().size()) - n_before;
  read_rest(path);
  auto& all = document.understood();
  std::rotate(all.begin() + n_before, all.begin() + n_before + n_path, all.end());
  return path;
}

ElementTest understand_element_test(Document& document, const std::string& folder) {
  ElementTest test;
  Section root = Section::root(document, &element_test_declaration());
  test.title = root.text(title_of_test);
  test.segments = read_path(document, root, folder, [&](const std::vector<Segment>& path) {
    Section material = root.section(material_table);
    const bool confined = std::any_of(path.begin(), path.end(), controls_a_stress);
    test.law = read_law(material, Preset::standard, {}, confined);
    material.close(fmt::format("law `{}`", name_of(test.law)));
    if (!material.is_given_up())
      test.initial = read_initial(root, test);
    else
      root.has(initial.key);
    read_driver(root, test);
  });
  root.close();
  for (const Mistake& m : check_rows(test)) root.complain(m);
  if (document.is_right())
    for (const Mistake& m : check_start(test)) root.complain(m);
  return test;
}

ElementTestFile read_element_test_text(const std::string& name, std::string_view text, const std::string& folder) {
  Document document(name, text);
  ElementTest what = understand_element_test(document, folder);
  document.finish();
  return {std::move(what), std::move(document.understood())};
}

ElementTestFile read_element_test(const std::string& path, const std::vector<Override>& overrides) {
  Document document(path);
  document.replace(overrides);
  ElementTest what = understand_element_test(document, std::filesystem::path(path).parent_path().string());
  document.finish();
  return {std::move(what), std::move(document.understood())};
}

}  // namespace talus
