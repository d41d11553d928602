#include <fmt/format.h>

#include <functional>

#include "talus/input/segments.hpp"

namespace talus {

namespace {

/// A test by its name: the strain that leads it, the controls for the course of that strain, and those that go to a stress
/// if the user gave one.
struct NamedTest {
  std::string leading;
  std::string_view meaning;
  std::function<Controls(Course)> controls;
  std::optional<Controls> to_stress;
};

int read_axis(Section& s, int by_default) {
  static constexpr Choice axes[][3] = {{{"x", ""}, {"y", ""}, {"z", ""}}, {{"y", ""}, {"x", ""}, {"z", ""}}};
  static constexpr int numbers[][3] = {{0, 1, 2}, {1, 0, 2}};
  return numbers[by_default][s.choice({"axis", "axis of the loading", axes[by_default]})];
}

NamedTest read_isotropic_compression(Section& s) {
  NamedTest test{"volumetric_strain", "change of volumetric strain, compression-positive", isotropic_compression, {}};
  if (const auto p = s.optional_number({"pressure", "Pa", Range::not_negative(), "pressure to go to"}))
    test.to_stress = isotropic_compression_to(*p);
  return test;
}

NamedTest read_oedometer(Section& s) {
  const int axis = read_axis(s, 1);
  NamedTest test{"axial_strain",
                 "change of axial strain, compression-positive",
                 [axis](Course strain) { return oedometer(axis, strain); },
                 {}};
  if (const auto stress = s.optional_number({"axial_stress", "Pa", Range::not_negative(), "axial stress to go to"}))
    test.to_stress = oedometer_to(axis, *stress);
  return test;
}

NamedTest read_triaxial(Section& s) {
  static constexpr Choice kinds[] = {
      {"undrained", "constant volume"}, {"drained", "lateral stress held"}, {"constant_p", "mean stress held"}};
  const auto drainage =
      TriaxialDrainage(s.required_choice({"drainage", "what is held besides the axial strain", kinds}));
  const int axis = read_axis(s, 0);
  NamedTest test{"axial_strain",
                 "change of axial strain; negative is extension",
                 [=](Course strain) { return triaxial(drainage, axis, strain); },
                 {}};
  if (const auto stress = s.optional_number({"axial_stress", "Pa", {}, "axial stress to go to"}))
    test.to_stress = triaxial_to(drainage, axis, *stress);
  return test;
}

NamedTest read_simple_shear(Section& s) {
  static constexpr Choice kinds[] = {{"undrained", "constant volume"},
                                     {"constant_normal_stress", "normal stress on the shear plane held"}};
  const auto drainage = ShearDrainage(s.required_choice({"drainage", "what is held besides the shear strain", kinds}));
  static constexpr Choice planes[] = {{"xy", ""}, {"yz", ""}, {"zx", ""}};
  const int plane = s.choice({"plane", "component of the shear strain", planes});
  NamedTest test{"shear_strain",
                 "change of the tensor shear strain, half the engineering shear strain",
                 [=](Course strain) { return simple_shear(drainage, plane, strain); },
                 {}};
  if (const auto stress = s.optional_number({"shear_stress", "Pa", {}, "shear stress to go to"}))
    test.to_stress = simple_shear_to(drainage, plane, *stress);
  return test;
}

NamedTest read_test(Section& s) {
  static constexpr Choice tests[] = {
      {"isotropic_compression", "equal strain or stress along all axes"},
      {"oedometer", "strain along one axis only"},
      {"triaxial", "strain along one axis; drained, undrained or at constant mean stress"},
      {"simple_shear", "one shear strain; undrained or under constant normal stress"}};
  static constexpr NamedTest (*readers[])(Section&) = {read_isotropic_compression, read_oedometer, read_triaxial,
                                                       read_simple_shear};
  return readers[s.choice({"test", "a test by its name", tests})](s);
}

std::vector<Segment> read_turning_points(Section& s, const Segment& segment, const NamedTest& test) {
  if (segment.first_row > 0) s.complain("first_row", "and `reversals` exclude each other: every way would start anew");
  const std::vector<double> turning_points =
      s.numbers({"reversals",
                 "1",
                 {},
                 "turning points: values of the leading strain since the start of the segment, the last one its end"},
                0);
  std::vector<Segment> segments = between_turning_points(segment, turning_points, test.controls);
  if (segments.empty()) s.complain("reversals", "goes nowhere");
  return segments;
}

}  // namespace

std::vector<Segment> read_named_test(Section& s, Segment segment) {
  const NamedTest test = read_test(s);
  const std::string rate = test.leading + "_rate", acceleration = test.leading + "_acceleration";
  const bool by_rate = s.has(rate) || s.has(acceleration), turning = s.has("reversals"), change = s.has(test.leading);
  if (int(by_rate) + int(turning) + int(change) + int(test.to_stress.has_value()) != 1)
    s.complain(fmt::format("must say one of `{}`, `{}` (with `{}`), `reversals` and a stress to go to", test.leading,
                           rate, acceleration));
  if (turning && !test.to_stress && !by_rate) return read_turning_points(s, segment, test);
  if (test.to_stress) {
    segment.controls = *test.to_stress;
  } else if (by_rate) {
    const double r = s.number({rate, "1/s", {}, "its rate at the start of the segment"}, 0),
                 a = s.number({acceleration, "1/s2", {}, "growth of its rate"}, 0);
    segment.controls = test.controls({r, a});
  } else {
    const double strain = change ? s.number({test.leading, "1", {}, test.meaning}) : 0;
    segment.controls = test.controls({strain / segment.duration, 0});
  }
  return {segment};
}

}  // namespace talus
