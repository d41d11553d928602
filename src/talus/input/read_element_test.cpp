#include <fmt/format.h>

#include <cmath>
#include <filesystem>
#include <functional>
#include <stdexcept>

#include "talus/base/table.hpp"
#include "talus/base/text.hpp"
#include "talus/base/units.hpp"
#include "talus/input/read_law.hpp"
#include "talus/mpm/start/overburden.hpp"

namespace talus {

namespace {

constexpr double most_rows = 1e7;  ///< of all segments

constexpr const char* component_names[] = {"xx", "yy", "zz", "xy", "yz", "zx"};

int component(std::string_view name) {
  for (int i = 0; i < 6; ++i)
    if (name == component_names[i]) return i;
  return -1;
}

const Parameter component_rate{
    "strain_rate", "1/s", {}, "strain rate at the start of the segment, compression-positive"};
const Parameter component_acceleration{"strain_acceleration", "1/s2", {}, "growth of the strain rate"};
const Parameter component_strain{"strain", "1", {}, "change of strain over the segment, compression-positive"};

// ---- conditions on single components -----------------------------------------------------------------------------

Control on_strain(int i, double rate, double acceleration) {
  Control c;
  c.of_strain[i] = 1;
  c.rate = rate;
  c.acceleration = acceleration;
  c.name = fmt::format("strain_{}", component_names[i]);
  return c;
}
Control held_stress(int i) {
  Control c;
  c.of_stress[i] = 1;
  c.name = fmt::format("stress_{}", component_names[i]);
  return c;
}
Control stress_to(int i, double target) {
  Control c = held_stress(i);
  c.to_target = true;
  c.target = target;
  return c;
}

/// xx = { strain = 0.2 } or { strain_rate = "...", strain_acceleration = "..." } or { stress = "100 kPa" }
///      or { stress = "held" } or { stress_rate = "1 kPa/s" }
Control read_control(Section& s, int i, double duration) {
  const Parameter stress{"stress", "Pa", {}, "stress to go to, compression-positive, or \"held\""};
  const Parameter stress_rate{"stress_rate", "Pa/s", {}, "growth of the stress, compression-positive"};
  Control c = on_strain(i, 0, 0);
  const int ways = int(s.has("strain")) + int(s.has("strain_rate") || s.has("strain_acceleration")) +
                   int(s.has("stress")) + int(s.has("stress_rate"));
  if (ways != 1)
    s.complain("must say one of `strain`, `strain_rate` (with `strain_acceleration`), `stress` and `stress_rate`");
  if (s.has("strain")) c = on_strain(i, s.number(component_strain) / duration, 0);
  if (s.has("strain_rate") || s.has("strain_acceleration"))
    c = on_strain(i, s.number(component_rate, 0), s.number(component_acceleration, 0));
  if (s.has("stress")) {
    if (s.is_text("stress", "held")) {
      s.text("stress", stress.meaning);
      c = held_stress(i);
    } else {
      c = stress_to(i, s.number(stress));
    }
  }
  if (s.has("stress_rate")) {
    c = held_stress(i);
    c.rate = s.number(stress_rate);
  }
  s.close("a component");
  return c;
}

// ---- named tests -------------------------------------------------------------------------------------------------

/// How the leading strain of a named test runs: a rate and its growth.
struct Course {
  double rate = 0, acceleration = 0;
};
using Controls = std::array<Control, 6>;

/// A test by its name: the strain that leads it, and the controls that follow from the course of that strain.
struct NamedTest {
  std::string leading;
  std::string_view meaning;
  std::function<Controls(Course)> controls;
  std::function<std::optional<Controls>()> to_stress = [] {
    return std::nullopt;
  };  ///< if the user gave a stress to go to instead
};

Controls no_strain() {
  Controls c;
  for (int i = 0; i < 6; ++i) c[i] = on_strain(i, 0, 0);
  return c;
}

int read_axis(Section& s, int by_default) {
  static constexpr Choice axes[][3] = {{{"x", ""}, {"y", ""}, {"z", ""}}, {{"y", ""}, {"x", ""}, {"z", ""}}};
  static constexpr int numbers[][3] = {{0, 1, 2}, {1, 0, 2}};
  return numbers[by_default][s.choice({"axis", "axis of the loading", axes[by_default]})];
}

NamedTest isotropic_compression(Section& s) {
  NamedTest test{"volumetric_strain", "change of volumetric strain, compression-positive", {}};
  test.controls = [](Course v) {
    Controls c = no_strain();
    for (int i = 0; i < 3; ++i) c[i] = on_strain(i, v.rate / 3, v.acceleration / 3);
    return c;
  };
  test.to_stress = [&s]() -> std::optional<Controls> {
    const std::optional<double> p = s.optional_number({"pressure", "Pa", Range::not_negative(), "pressure to go to"});
    if (!p) return std::nullopt;
    Controls c = no_strain();
    for (int i = 0; i < 3; ++i) c[i] = stress_to(i, *p);
    return c;
  };
  return test;
}

NamedTest oedometer(Section& s) {
  const int axis = read_axis(s, 1);
  NamedTest test{"axial_strain", "change of axial strain, compression-positive", {}};
  test.controls = [axis](Course a) {
    Controls c = no_strain();
    c[axis] = on_strain(axis, a.rate, a.acceleration);
    return c;
  };
  test.to_stress = [&s, axis]() -> std::optional<Controls> {
    const std::optional<double> target =
        s.optional_number({"axial_stress", "Pa", Range::not_negative(), "axial stress to go to"});
    if (!target) return std::nullopt;
    Controls c = no_strain();
    c[axis] = stress_to(axis, *target);
    return c;
  };
  return test;
}

NamedTest triaxial(Section& s) {
  static constexpr Choice kinds[] = {
      {"undrained", "constant volume"}, {"drained", "lateral stress held"}, {"constant_p", "mean stress held"}};
  const int kind = s.required_choice({"drainage", "what is held besides the axial strain", kinds});
  const int axis = read_axis(s, 0), side = (axis + 1) % 3, other = (axis + 2) % 3;
  NamedTest test{"axial_strain", "change of axial strain; negative is extension", [=](Course a) {
                   Controls c = no_strain();
                   c[axis] = on_strain(axis, a.rate, a.acceleration);
                   if (kind == 0) {
                     for (int i : {side, other}) c[i] = on_strain(i, -a.rate / 2, -a.acceleration / 2);
                   } else if (kind == 1) {
                     for (int i : {side, other}) c[i] = held_stress(i);
                   } else {  // the sum of the normal stresses is held, and the lateral strains stay equal
                     c[side] = held_stress(side);
                     c[side].of_stress = {1, 1, 1, 0, 0, 0};
                     c[side].name = "mean stress (times 3)";
                     c[other] = on_strain(other, 0, 0);
                     c[other].of_strain[side] = -1;
                   }
                   return c;
                 }};
  test.to_stress = [&s, kind, axis, side, other, controls = test.controls]() -> std::optional<Controls> {
    const std::optional<double> target = s.optional_number({"axial_stress", "Pa", {}, "axial stress to go to"});
    if (!target) return std::nullopt;
    Controls c = controls({});
    c[axis] = stress_to(axis, *target);
    if (kind == 0)  // constant volume, whatever the axial strain turns out to be
      for (int i : {side, other}) c[i].of_strain[axis] = 0.5;
    return c;
  };
  return test;
}

NamedTest simple_shear(Section& s) {
  static constexpr Choice kinds[] = {{"undrained", "constant volume"},
                                     {"constant_normal_stress", "normal stress on the shear plane held"}};
  const int kind = s.required_choice({"drainage", "what is held besides the shear strain", kinds});
  static constexpr Choice planes[] = {{"xy", ""}, {"yz", ""}, {"zx", ""}};
  const int plane = s.choice({"plane", "component of the shear strain", planes});
  NamedTest test{"shear_strain", "change of the tensor shear strain, half the engineering shear strain", [=](Course g) {
                   Controls c = no_strain();
                   c[3 + plane] = on_strain(3 + plane, g.rate, g.acceleration);
                   // Planes of shear xy are normal to y, those of yz to z, those of zx to x.
                   const int normal = (plane + 1) % 3;
                   if (kind == 1) c[normal] = held_stress(normal);
                   return c;
                 }};
  test.to_stress = [&s, plane, controls = test.controls]() -> std::optional<Controls> {
    const std::optional<double> target = s.optional_number({"shear_stress", "Pa", {}, "shear stress to go to"});
    if (!target) return std::nullopt;
    Controls c = controls({});
    c[3 + plane] = stress_to(3 + plane, *target);
    return c;
  };
  return test;
}

constexpr Choice named_tests[] = {{"isotropic_compression", "equal strain or stress along all axes"},
                                  {"oedometer", "strain along one axis only"},
                                  {"triaxial", "strain along one axis; drained, undrained or at constant mean stress"},
                                  {"simple_shear", "one shear strain; undrained or under constant normal stress"}};

NamedTest named_test(int which, Section& s) {
  switch (which) {
    case 0: return isotropic_compression(s);
    case 1: return oedometer(s);
    case 2: return triaxial(s);
    default: return simple_shear(s);
  }
}

/// One segment, or with turning points (`reversals`) one for every way between them.
std::vector<Segment> read_named_test(Section& s, Segment segment) {
  const NamedTest test = named_test(s.choice({"test", "a test by its name", named_tests}), s);
  const std::string rate = test.leading + "_rate", acceleration = test.leading + "_acceleration";
  const bool by_rate = s.has(rate) || s.has(acceleration), turning = s.has("reversals"), change = s.has(test.leading);
  const Parameter of_change{test.leading, "1", {}, test.meaning},
      of_rate{rate, "1/s", {}, "its rate at the start of the segment"},
      of_acceleration{acceleration, "1/s2", {}, "growth of its rate"};
  const std::optional<Controls> to_stress = test.to_stress();
  if (int(by_rate) + int(turning) + int(change) + int(to_stress.has_value()) != 1)
    s.complain(fmt::format("must say one of `{}`, `{}` (with `{}`), `reversals` and a stress to go to", test.leading,
                           rate, acceleration));
  if (to_stress) {
    segment.controls = *to_stress;
    return {segment};
  }
  if (by_rate) {
    const double r = s.number(of_rate, 0), a = s.number(of_acceleration, 0);
    segment.controls = test.controls({r, a});
    return {segment};
  }
  if (!turning) {
    segment.controls = test.controls({(change ? s.number(of_change) : 0.0) / segment.duration, 0});
    return {segment};
  }
  if (segment.first_row > 0) s.complain("first_row", "and `reversals` exclude each other: every way would start anew");
  const std::vector<double> turns =
      s.numbers({"reversals",
                 "1",
                 {},
                 "turning points: values of the leading strain since the start of the segment, the last one its end"},
                0);
  double length = 0, last = 0;
  for (double turn : turns) {
    length += std::abs(turn - last);
    last = turn;
  }
  std::vector<Segment> segments;
  last = 0;
  for (double turn : turns) {
    const double share = length > 0 ? std::abs(turn - last) / length : 0;
    if (share > 0) {
      Segment part = segment;
      part.duration = segment.duration * share;
      part.rows = std::max(1, int(std::lround(segment.rows * share)));
      part.controls = test.controls({(turn - last) / part.duration, 0});
      segments.push_back(part);
    }
    last = turn;
  }
  if (segments.empty()) s.complain("reversals", "goes nowhere");
  return segments;
}

// ---- a path from a table -----------------------------------------------------------------------------------------

/// Reads strain rates from a CSV file with the columns time and rate_xx ... rate_zx (those left out are zero), in s and
/// 1/s.
std::vector<RateInstant> read_rates(Section& s, const std::string& path) {
  std::vector<RateInstant> instants;
  try {
    const NumberTable table = read_csv(path);
    std::vector<int> columns;
    for (const std::string& name : table.names) {
      const std::string word = name.substr(0, name.find(" ["));  // without the unit, as talus writes it
      const int i = word.rfind("rate_", 0) == 0 ? component(word.substr(5)) : -1;
      if (word != "time" && i < 0)
        throw std::runtime_error(fmt::format(
            "{}: unknown column `{}`; columns are time, rate_xx, rate_yy, rate_zz, rate_xy, rate_yz, rate_zx", path,
            word));
      columns.push_back(i);
    }
    for (std::size_t i = 0; i < table.rows.size(); ++i) {
      RateInstant r{std::nan(""), {}};
      for (std::size_t c = 0; c < columns.size(); ++c) {
        const double value = table.rows[i][c];
        if (!std::isfinite(value))
          throw std::runtime_error(fmt::format("{}:{}: a value is missing or not finite", path, table.lines[i]));
        (columns[c] < 0 ? r.time : r.rate[columns[c]]) = value;
      }
      if (!(instants.empty() ? r.time == 0 : r.time > instants.back().time))
        throw std::runtime_error(fmt::format("{}:{}: times must begin with 0 and grow", path, table.lines[i]));
      instants.push_back(r);
    }
    if (instants.size() < 2) throw std::runtime_error(fmt::format("{} holds fewer than two instants", path));
  } catch (const std::runtime_error& e) {
    s.complain("rates", e.what());
    return {};
  }
  return instants;
}

std::vector<Segment> read_segment(Section& s, const std::string& folder) {
  Segment segment;
  std::vector<Segment> segments;
  segment.rows = s.whole_number("rows", 1, 1000000, 100, "rows of output");
  if (s.has("rates")) {
    const std::string file = s.text("rates", "CSV file of strain rates: time, rate_xx, ...; linear between instants");
    segment.history = read_rates(s, (std::filesystem::path(folder) / file).string());
    if (!segment.history.empty()) segment.duration = segment.history.back().time;
    segment.controls = no_strain();
    for (int i = 0; i < 6; ++i)
      if (s.has(component_names[i])) {
        Section c =
            s.section(component_names[i], "a stress that is controlled while the other strains follow the table");
        segment.controls[i] = read_control(c, i, segment.duration);
        if (segment.controls[i].of_strain[i] != 0)
          s.complain(component_names[i], "must control a stress; strains come from the table");
      }
    segments = {segment};
  } else {
    segment.duration =
        s.number({"duration", "s", Range::positive(), "how long the segment lasts"}, 1.0, "only collisions feel it");
    if (!(segment.duration > 0)) segment.duration = 1;
    if (s.has("first_row")) {
      segment.first_row = s.number({"first_row", "s", Range::positive(),
                                    "time of the first row; from there the times grow by a constant factor"});
      if (segment.first_row >= segment.duration) s.complain("first_row", "must come before the end of the segment");
    }
    if (s.has("test")) {
      segments = read_named_test(s, segment);
    } else {
      segment.controls = no_strain();
      bool any = false;
      for (int i = 0; i < 6; ++i)
        if (s.has(component_names[i])) {
          Section c = s.section(component_names[i], "how this component is driven");
          segment.controls[i] = read_control(c, i, segment.duration);
          any = true;
        }
      if (!any) s.complain("drives nothing: give `test`, `rates`, or components such as xx = { strain = 0.1 }");
    }
    if (segments.empty()) segments = {segment};
  }
  s.close("a segment");
  return segments;
}

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

/// Whether a law remembers its collisional stress.
bool has_collisional_history(const AnyLaw& law) {
  if (const auto* alone = std::get_if<MuI>(&law)) return alone->form != CollisionalForm::total;
  return std::holds_alternative<GranularWithHistory>(law);
}

InitialState read_initial(Section& root, const AnyLaw& law) {
  Section s = root.section("initial", "the state before the test");
  InitialState initial;
  const Parameter pressure{"pressure", "Pa", Range::not_negative(), "isotropic pressure"};
  if (!has_lasting_contacts(law)) {
    initial.background_pressure = s.number(
        {"background_pressure", "Pa", Range::not_negative(), "constant pressure of contacts that are not modelled"});
  } else if (s.has("stress")) {
    if (s.has("pressure")) s.complain("pressure", "and `stress` exclude each other");
    initial.stress = read_stress(s, "stress", "stress of lasting contacts, compression-positive", 3);
  } else {
    initial.stress = opposite_sign(SymTensor<double>::isotropic(s.number(pressure)));
  }
  if (const std::optional<Range> range = void_ratios_of(law)) {
    initial.void_ratio = s.number({"void_ratio", "1", *range, "void ratio"});
    if (const std::string why = fault_of_void_ratio(law, initial.void_ratio); !why.empty())
      s.complain("void_ratio", why);
  }
  if (tells(law, "kappa"))
    initial.kappa =
        s.optional_number({"kappa", "1", Range::not_negative(),
                           "accumulated plastic deviatoric strain; without it, the least that carries the stress"});
  if (s.has("collisional_stress")) {
    initial.collisional_stress =
        read_stress(s, "collisional_stress", "stress of collisions at the start, compression-positive", 0);
    if (!has_collisional_history(law))
      s.complain(
          "collisional_stress",
          "follows from the strain rate in this law; collisional_form = \"rate\" or \"incremental\" remembers it");
  }
  s.close("[initial]");
  return initial;
}

}  // namespace

ElementTest understand_element_test(Document& document, const std::string& folder) {
  ElementTest test;
  Section root = Section::root(document);
  test.title = root.text("title", "what the test is, in one line");
  Section material = root.section("material", "the law and its parameters");
  test.law = read_law(material);
  material.close(fmt::format("law `{}`", name_of(test.law)));
  test.initial = read_initial(root, test.law);
  Section driver =
      root.has("driver") ? root.section("driver", "how the test is integrated") : Section::empty(root, "driver");
  test.integration.scheme =
      Integrator(driver.choice({"integrator", "how the frictional stress is integrated", integrator_choices}));
  test.integration.tolerance =
      driver.number({"tolerance", "1", Range::between(1e-12, 0.1), "relative error of the stress in a substep"}, 1e-6);
  test.tolerance = test.integration.tolerance;
  driver.close("[driver]");
  for (Section& s : root.list_of_sections("segment", "the loading path, segment after segment"))
    for (Segment& segment : read_segment(s, folder)) test.segments.push_back(std::move(segment));
  root.close("an element test");
  double rows = 0;
  for (const Segment& segment : test.segments) rows += segment.rows;
  if (rows > most_rows)
    root.complain(fmt::format("the segments make {:.3g} `rows`; at most {:.0e} are possible", rows, most_rows));
  if (document.is_right())
    if (const std::string why = std::visit(
            [&](const auto& law) {
              const auto state = law.at_rest(test.initial);
              const auto* reason = std::get_if<std::string>(&state);
              return reason ? *reason : "";
            },
            test.law);
        !why.empty())
      root.section("initial", "").complain("is impossible: " + why);
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
