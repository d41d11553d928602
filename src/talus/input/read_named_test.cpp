#include <fmt/format.h>

#include <functional>

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
  return {{change, "1", {}, meaning},
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
     "1",
     {},
     "turning points: values of the leading strain since the start of the segment, the last one its end"}};

constexpr Parameter final_pressure{"pressure", "Pa", Range::not_negative(), "pressure to go to"},
    final_stress_of_oedometer{"axial_stress", "Pa", Range::not_negative(), "axial stress to go to"},
    final_axial_stress{"axial_stress", "Pa", {}, "axial stress to go to"},
    final_shear_stress{"shear_stress", "Pa", {}, "shear stress to go to"};

constexpr Choice axes[] = {{"x", ""}, {"y", ""}, {"z", ""}};
constexpr Choice axes_of_oedometer[] = {{"y", ""}, {"x", ""}, {"z", ""}};
constexpr Option axis{"axis", "axis of the loading", axes}, axis_of_oedometer{"axis", axis.meaning, axes_of_oedometer};
constexpr Choice drainages_of_triaxial[] = {
    {"undrained", "constant volume"}, {"drained", "lateral stress held"}, {"constant_p", "mean stress held"}};
constexpr Option drainage_of_triaxial{"drainage", "what is held besides the axial strain", drainages_of_triaxial};
constexpr Choice drainages_of_shear[] = {{"undrained", "constant volume"},
                                         {"constant_normal_stress", "normal stress on the shear plane held"}};
constexpr Option drainage_of_shear{"drainage", "what is held besides the shear strain", drainages_of_shear};
constexpr Choice planes[] = {{"xy", ""}, {"yz", ""}, {"zx", ""}};
constexpr Option plane_of_shear{"plane", "component of the shear strain", planes};

/// A test by its name: the strain that leads it, the controls for the course of that strain, and those that go to a stress
/// if the user gave one.
struct NamedTest {
  const LeadingStrain& leading;
  std::function<Controls(Course)> controls;
  std::optional<Controls> to_stress;
};

NamedTest read_isotropic_compression(Section& s) {
  NamedTest test{volumetric_strain, isotropic_compression, {}};
  if (const auto p = s.optional_number(final_pressure)) test.to_stress = isotropic_compression_to(*p);
  return test;
}

NamedTest read_oedometer(Section& s) {
  static constexpr int numbers[] = {1, 0, 2};
  const int along = numbers[s.choice(axis_of_oedometer)];
  NamedTest test{strain_of_oedometer, [along](Course strain) { return oedometer(along, strain); }, {}};
  if (const auto stress = s.optional_number(final_stress_of_oedometer)) test.to_stress = oedometer_to(along, *stress);
  return test;
}

NamedTest read_triaxial(Section& s) {
  const auto drainage = TriaxialDrainage(s.required_choice(drainage_of_triaxial));
  const int along = s.choice(axis);
  NamedTest test{axial_strain, [=](Course strain) { return triaxial(drainage, along, strain); }, {}};
  if (const auto stress = s.optional_number(final_axial_stress)) test.to_stress = triaxial_to(drainage, along, *stress);
  return test;
}

NamedTest read_simple_shear(Section& s) {
  const auto drainage = ShearDrainage(s.required_choice(drainage_of_shear));
  const int plane = s.choice(plane_of_shear);
  NamedTest test{shear_strain, [=](Course strain) { return simple_shear(drainage, plane, strain); }, {}};
  if (const auto stress = s.optional_number(final_shear_stress))
    test.to_stress = simple_shear_to(drainage, plane, *stress);
  return test;
}

NamedTest read_test(Section& s) {
  static constexpr NamedTest (*readers[])(Section&) = {read_isotropic_compression, read_oedometer, read_triaxial,
                                                       read_simple_shear};
  return readers[s.choice(test_option)](s);
}

std::vector<Segment> read_turning_points(Section& s, const Segment& segment, const NamedTest& test) {
  if (segment.first_row > 0) s.complain("first_row", "and `reversals` exclude each other: every way would start anew");
  const std::vector<double> turns = s.numbers(turning_points);
  std::vector<Segment> segments = between_turning_points(segment, turns, test.controls);
  if (segments.empty()) s.complain("reversals", "goes nowhere");
  return segments;
}

}  // namespace

std::vector<Entry> entries_of_named_tests() {
  std::vector<Entry> all = {optional(test_option)};
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
  add(optional(final_shear_stress), {"simple_shear"});
  all.push_back(optional(turning_points));
  return all;
}

std::vector<Segment> read_named_test(Section& s, Segment segment) {
  const NamedTest test = read_test(s);
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
