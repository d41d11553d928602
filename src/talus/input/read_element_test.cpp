#include <fmt/format.h>

#include <filesystem>

#include "talus/case/material.hpp"
#include "talus/input/read_law.hpp"
#include "talus/input/segments.hpp"

namespace talus {

namespace {

/// A table of components, compression-positive; the first `required` of them must be there.
SymTensor<double> read_stress(Section& s, std::string_view key, std::string_view meaning, int required) {
  Section components = s.section(key, meaning);
  SymTensor<double> given = SymTensor<double>::zero();
  for (int i = 0; i < 6; ++i) {
    const Parameter p{component_names[i], "Pa", {}, "component of the stress, compression-positive"};
    given[i] = i < required ? components.number(p) : components.number(p, 0);
  }
  components.close("a stress");
  return opposite_sign(given);
}

/// The stress that the test starts from, of a law that carries one at rest.
SymTensor<double> read_initial_stress(Section& s) {
  if (!s.has("stress"))
    return opposite_sign(
        SymTensor<double>::isotropic(s.number({"pressure", "Pa", Range::not_negative(), "isotropic pressure"})));
  if (s.has("pressure")) s.complain("pressure", "and `stress` exclude each other");
  return read_stress(s, "stress", "stress of lasting contacts, compression-positive", 3);
}

InitialState read_initial(Section& root, const AnyLaw& law) {
  Section s = root.section("initial", "the state before the test");
  InitialState initial;
  if (has_lasting_contacts(law))
    initial.stress = read_initial_stress(s);
  else
    initial.background_pressure = s.number(
        {"background_pressure", "Pa", Range::not_negative(), "constant pressure of contacts that are not modelled"});
  if (const std::optional<Range> range = void_ratios_of(law)) {
    initial.void_ratio = s.number({"void_ratio", "1", *range, "void ratio"});
    if (const std::string why = fault_of_void_ratio(law, initial.void_ratio); !why.empty())
      s.complain("void_ratio", why);
  }
  if (has_quantity(law, "kappa"))
    initial.kappa =
        s.optional_number({"kappa", "1", Range::not_negative(),
                           "accumulated plastic deviatoric strain; without it, the least that carries the stress"});
  if (s.has("collisional_stress")) {
    initial.collisional_stress =
        read_stress(s, "collisional_stress", "stress of collisions at the start, compression-positive", 0);
    if (!remembers_collisional_stress(law))
      s.complain(
          "collisional_stress",
          "follows from the strain rate in this law; collisional_form = \"rate\" or \"incremental\" remembers it");
  }
  s.close("[initial]");
  return initial;
}

void read_driver(Section& root, ElementTest& test) {
  Section s =
      root.has("driver") ? root.section("driver", "how the test is integrated") : Section::empty(root, "driver");
  test.integration.scheme = Integrator(s.choice(
      {"integrator", "how the frictional stress is integrated", integrator_choices}, int(test.integration.scheme)));
  test.integration.tolerance =
      s.number({"tolerance", "1", Range::between(1e-12, 0.1), "relative error of the stress in a substep"},
               test.integration.tolerance);
  test.tolerance = test.integration.tolerance;
  s.close("[driver]");
}

}  // namespace

ElementTest understand_element_test(Document& document, const std::string& folder) {
  ElementTest test;
  Section root = Section::root(document);
  test.title = root.text("title", "what the test is, in one line");
  Section material = root.section("material", "the law and its parameters");
  test.law = read_law(material, Preset::standard);
  material.close(fmt::format("law `{}`", name_of(test.law)));
  test.initial = read_initial(root, test.law);
  read_driver(root, test);
  for (Section& s : root.list_of_sections("segment", "the loading path, segment after segment"))
    for (Segment& segment : read_segment(s, folder)) test.segments.push_back(std::move(segment));
  root.close("an element test");
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

ElementTestFile read_element_test(const std::string& path) {
  Document document(path);
  ElementTest what = understand_element_test(document, std::filesystem::path(path).parent_path().string());
  document.finish();
  return {std::move(what), std::move(document.understood())};
}

}  // namespace talus
