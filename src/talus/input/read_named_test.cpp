#include <fmt/format.h>

#include <functional>

#include "talus/base/units.hpp"
#include "talus/input/segments.hpp"

namespace talus {

namespace {

constexpr Choice tests[] = {{"isotropic_compression", "equal strain or stress along all axes"},
                            {"oedometer", "strain along one axis only"},
                            {"triaxial", "strain along one axis; drained, undrained or at constant mean stress"},
                            {"simple_shear", "one shear strain; undrained or under constant normal stress"}};
constexpr Option test_option{"test", "a test by its name", tests};

/// The strain that leads a test: its change, or its rate and the growth of that.
struct LeadingStrain {
  Parameter change, rate, acceleration;
};
constexpr LeadingStrain leading_strain(std::string_view change, std::string_view rate, std::string_view acceleration,
                                       std::string_view meaning) {
  return {{change, unit_of_strain, {}, meaning},
          {rate, "1/s", {}, "its rate at the start of the segment"},
          {acceleration, "1/s2", {}, "growth of its rate"}};
}
constexpr LeadingStrain volumetric_strain = leading_strain("volumetric_strain", "volumetric_strain_rate",
                                                           "volumetric_strain_acceleration",
                                                           "change of volumetric strain, compression-positive"),
                        strain_of_oedometer =
                            leading_strain("axial_strain", "axial_strain_rate", "axial_strain_acceleration",
                                           "change of axial strain, compression-positive"),
                        axial_strain = leading_strain("axial_strain", "axial_strain_rate", "axial_strain_acceleration",
                                                      "change of axial strain; negative is extension"),
                        shear_strain =
                            leading_strain("shear_strain", "shear_strain_rate", "shear_strain_acceleration",
                                           "change of the tensor shear strain, half the engineering shear strain");
constexpr Numbers turning_points{
    {"reversals",
     unit_of_strain,
     {},
     "turning points: values of the leading strain since the start of the segment, the last one its end"}};

constexpr Parameter final_pressure{"pressure", "Pa", pressures, "pressure to go to"},
    final_stress_of_oedometer{"axial_stress", "Pa", pressures, "axial stress to go to"},
    final_axial_stress{"axial_stress", "Pa", stresses, "axial stress to go to"},
    final_q{"q", "Pa", stresses, "deviator stress to go to, axial less lateral stress"},
    final_shear_stress{"shear_stress", "Pa", stresses, "shear stress to go to"};

/// Cycles of a leading strain between two values of it, or of a stress.
struct Cycles {
  Numbers strains, stresses;
  Measure stress;
};
constexpr Cycles cycles_between(std::string_view strain, std::string_view stress, Measure measure) {
  return {{{strain, unit_of_strain, {}, "the strains, since the start of the segment, between which cycles go"}, 2},
          {{stress, "Pa", stresses, "the stresses between which cycles go, at the rate of the leading strain"}, 2},
          measure};
}
constexpr Cycles cycles_of_triaxial = cycles_between("axial_strain_between", "q_between", Measure::q),
                 cycles_of_shear =
                     cycles_between("shear_strain_between", "shear_stress_between", Measure::shear_stress);
constexpr WholeNumber number_of_cycles{{"cycles", "1", Range::between(1, 100000), "how many cycles"}};
constexpr Parameter longest_way{"longest_way",
                                unit_of_strain,
                                {0, most_normal_strain, true, false},
                                "leading strain after which a turning stress counts as out of reach"};

constexpr Choice axes[] = {{"x", ""}, {"y", ""}, {"z", ""}};
constexpr Choice axes_of_oedometer[] = {{"y", ""}, {"x", ""}, {"z", ""}};
constexpr Option axis{"axis", "axis of the loading", axes}, axis_of_oedometer{"axis", axis.meaning, axes_of_oedometer};
constexpr Choice drainages_of_triaxial[] = {
    {"undrained", "constant volume"}, {"drained", "constant lateral stress"}, {"constant_p", "constant mean stress"}};
constexpr Option drainage_of_triaxial{"drainage", "condition besides the axial strain", drainages_of_triaxial};
constexpr Choice drainages_of_shear[] = {{"undrained", "constant volume"},
                                         {"constant_normal_stress", "constant normal stress on the shear plane"}};
constexpr Option drainage_of_shear{"drainage", "condition besides the shear strain", drainages_of_shear};
constexpr Choice planes[] = {{"xy", ""}, {"yz", ""}, {"zx", ""}};
constexpr Option plane_of_shear{"plane", "component of the shear strain", planes};

/// A test by its name: the strain that leads it, the controls for the course of that strain, and those that go to a stress
/// if the user gave one.
struct NamedTest {
  const LeadingStrain& leading;
  std::function<Controls(Course)> controls;
  std::optional<Controls> to_stress;
  Laboratory laboratory{};
  const Cycles* cycles = nullptr;
};

NamedTest read_isotropic_compression(Section& s) {
  NamedTest test{volumetric_strain, isotropic_compression, {}};
  if (const auto p = s.optional_number(final_pressure)) test.to_stress = isotropic_compression_to(*p);
  return test;
}

NamedTest read_oedometer(Section& s) {
  static constexpr int numbers[] = {1, 0, 2};
  const int along = numbers[s.choice(axis_of_oedometer)];
  NamedTest test{strain_of_oedometer, [along](Course strain) { return oedometer(along, strain); }, {}, {along}};
  if (const auto stress = s.optional_number(final_stress_of_oedometer)) test.to_stress = oedometer_to(along, *stress);
  return test;
}

NamedTest read_triaxial(Section& s) {
  const auto drainage = TriaxialDrainage(s.required_choice(drainage_of_triaxial));
  const int along = s.choice(axis);
  NamedTest test{axial_strain,
                 [=](Course strain) { return triaxial(drainage, along, strain); },
                 {},
                 {along, -1, drainage == TriaxialDrainage::undrained},
                 &cycles_of_triaxial};
  if (const auto stress = s.optional_number(final_axial_stress)) test.to_stress = triaxial_to(drainage, along, *stress);
  if (const auto q = s.optional_number(final_q)) {
    if (test.to_stress) s.complain("q", "and `axial_stress` exclude each other");
    test.to_stress = triaxial_to_q(drainage, along, *q);
  }
  return test;
}

NamedTest read_simple_shear(Section& s) {
  const auto drainage = ShearDrainage(s.required_choice(drainage_of_shear));
  const int plane = s.choice(plane_of_shear);
  NamedTest test{shear_strain,
                 [=](Course strain) { return simple_shear(drainage, plane, strain); },
                 {},
                 {(plane + 1) % 3, plane, drainage == ShearDrainage::undrained},
                 &cycles_of_shear};
  if (const auto stress = s.optional_number(final_shear_stress))
    test.to_stress = simple_shear_to(drainage, plane, *stress);
  return test;
}

std::optional<NamedTest> read_test(Section& s) {
  static constexpr NamedTest (*readers[])(Section&) = {read_isotropic_compression, read_oedometer, read_triaxial,
                                                       read_simple_shear};
  const std::optional<int> chosen = s.deciding_choice(test_option);
  if (!chosen) return std::nullopt;
  return readers[*chosen](s);
}

/// Cycles between two strains, at an even speed over the duration, or between two stresses, at a rate.
std::vector<Segment> read_cycles(Section& s, const Segment& segment, const NamedTest& test) {
  const int n = s.whole_number(number_of_cycles, 1);
  const Cycles& keys = *test.cycles;
  const bool by_stress = s.has(keys.stresses.key);
  const std::vector<double> between = s.numbers(by_stress ? keys.stresses : keys.strains);
  if (segment.first_row > 0) s.complain("first_row", "and cycles exclude each other");
  if (between[0] == between[1]) {
    s.complain(by_stress ? keys.stresses.key : keys.strains.key, "must be two different values");
    return {};
  }
  if (!by_stress) {
    std::vector<double> turns;
    for (int i = 0; i < 2 * n; ++i) turns.push_back(between[std::size_t(i % 2)]);
    return between_turning_points(segment, turns, test.controls);
  }
  const double rate = s.has(test.leading.rate.key) ? s.number(test.leading.rate, 0) : 0;
  const double longest = s.number(longest_way, 0.5);
  if (!(rate > 0)) {
    s.complain(fmt::format("cycles between stresses need `{}`, greater than 0", test.leading.rate.key));
    return {};
  }
  return between_stresses(segment, keys.stress, {between[0], between[1]}, n, rate, longest, test.controls);
}

std::vector<Segment> read_turning_points(Section& s, const Segment& segment, const NamedTest& test) {
  if (segment.first_row > 0) s.complain("first_row", "and `reversals` exclude each other");
  const std::vector<double> turns = s.numbers(turning_points);
  std::vector<Segment> segments = between_turning_points(segment, turns, test.controls);
  if (segments.empty()) s.complain("reversals", "goes nowhere");
  return segments;
}

}  // namespace

std::vector<Entry> entries_of_named_tests() {
  std::vector<Entry> all = {depends(test_option)};
  const auto add = [&](const Entry& e, std::vector<std::string> of_tests) { all.push_back(e.with("test", of_tests)); };
  const auto add_strain = [&](const LeadingStrain& strain, const std::string& test) {
    for (const Parameter& p : {strain.change, strain.rate, strain.acceleration}) add(optional(p), {test});
  };
  add(required(drainage_of_triaxial), {"triaxial"});
  add(required(drainage_of_shear), {"simple_shear"});
  add(optional(axis_of_oedometer), {"oedometer"});
  add(optional(axis), {"triaxial"});
  add(optional(plane_of_shear), {"simple_shear"});
  add_strain(volumetric_strain, "isotropic_compression");
  add_strain(strain_of_oedometer, "oedometer");
  add_strain(axial_strain, "triaxial");
  add_strain(shear_strain, "simple_shear");
  add(optional(final_pressure), {"isotropic_compression"});
  add(optional(final_stress_of_oedometer), {"oedometer"});
  add(optional(final_axial_stress), {"triaxial"});
  add(optional(final_q), {"triaxial"});
  add(optional(final_shear_stress), {"simple_shear"});
  all.push_back(optional(turning_points));
  for (const Numbers& n : {cycles_of_triaxial.strains, cycles_of_triaxial.stresses}) add(depends(n), {"triaxial"});
  for (const Numbers& n : {cycles_of_shear.strains, cycles_of_shear.stresses}) add(depends(n), {"simple_shear"});
  add(optional(number_of_cycles), {"triaxial", "simple_shear"});
  add(optional(longest_way), {"triaxial", "simple_shear"});
  return all;
}

std::vector<Segment> read_named_test(Section& s, Segment segment) {
  const std::optional<NamedTest> known = read_test(s);
  if (!known) {
    s.give_up();
    return {segment};
  }
  const NamedTest& test = *known;
  segment.laboratory = test.laboratory;
  const bool cyclic = test.cycles && (s.has(test.cycles->strains.key) || s.has(test.cycles->stresses.key));
  if (cyclic) {
    const bool both = s.has(test.cycles->strains.key) && s.has(test.cycles->stresses.key);
    if (both || test.to_stress || s.has(test.leading.change.key) || s.has(test.leading.acceleration.key) ||
        s.has("reversals") || (s.has(test.cycles->strains.key) && s.has(test.leading.rate.key)))
      s.complain(fmt::format(
          "cycles are between two strains (`{}`), or between two stresses (`{}` with `{}`), and nothing else",
          test.cycles->strains.key, test.cycles->stresses.key, test.leading.rate.key));
    return read_cycles(s, segment, test);
  }
  const auto& [of_change, of_rate, of_acceleration] = test.leading;
  const bool by_rate = s.has(of_rate.key) || s.has(of_acceleration.key), turning = s.has("reversals"),
             change = s.has(of_change.key);
  if (int(by_rate) + int(turning) + int(change) + int(test.to_stress.has_value()) != 1)
    s.complain(fmt::format("must say one of `{}`, `{}` (with `{}`), `reversals` and a stress to go to", of_change.key,
                           of_rate.key, of_acceleration.key));
  if (turning && !test.to_stress && !by_rate) return read_turning_points(s, segment, test);
  if (test.to_stress) {
    segment.controls = *test.to_stress;
  } else if (by_rate) {
    const double rate = s.number(of_rate, 0), acceleration = s.number(of_acceleration, 0);
    segment.controls = test.controls({rate, acceleration});
  } else {
    const double strain = change ? s.number(of_change) : 0;
    segment.controls = test.controls({strain / segment.duration, 0});
  }
  return {segment};
}

}  // namespace talus
