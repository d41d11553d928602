#include "talus/case/loading.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace talus {

namespace {

constexpr double most_rows = 1e7;  ///< of all segments

/// The two axes normal to another one.
std::array<int, 2> sides_of(int axis) { return {(axis + 1) % 3, (axis + 2) % 3}; }

}  // namespace

std::vector<Mistake> check_rows(const ElementTest& test) {
  double rows = 0;
  for (const Segment& segment : test.segments) rows += segment.rows;
  if (!(rows > most_rows)) return {};
  return {{{}, "", fmt::format("the segments make {:.3g} `rows`; at most {:.0e} are possible", rows, most_rows)}};
}

std::vector<Mistake> check_start(const ElementTest& test) {
  return std::visit(
      [&](const auto& law) -> std::vector<Mistake> {
        const auto state = law.at_rest(test.initial);
        const auto* reason = std::get_if<std::string>(&state);
        if (!reason) return {};
        return {{{"initial"}, "", "is impossible: " + *reason}};
      },
      test.law);
}

Control strain_control(int component, double rate, double acceleration) {
  Control c;
  c.of_strain[std::size_t(component)] = 1;
  c.rate = rate;
  c.acceleration = acceleration;
  c.name = fmt::format("strain_{}", component_names[component]);
  return c;
}

Control held_stress(int component) {
  Control c;
  c.of_stress[std::size_t(component)] = 1;
  c.name = fmt::format("stress_{}", component_names[component]);
  return c;
}

Control stress_to(int component, double target) {
  Control c = held_stress(component);
  c.to_target = true;
  c.target = target;
  return c;
}

Controls no_strain() {
  Controls c;
  for (int i = 0; i < 6; ++i) c[std::size_t(i)] = strain_control(i, 0);
  return c;
}

Controls isotropic_compression(Course v) {
  Controls c = no_strain();
  for (int i = 0; i < 3; ++i) c[std::size_t(i)] = strain_control(i, v.rate / 3, v.acceleration / 3);
  return c;
}

Controls isotropic_compression_to(double pressure) {
  Controls c = no_strain();
  for (int i = 0; i < 3; ++i) c[std::size_t(i)] = stress_to(i, pressure);
  return c;
}

Controls oedometer(int axis, Course a) {
  Controls c = no_strain();
  c[std::size_t(axis)] = strain_control(axis, a.rate, a.acceleration);
  return c;
}

Controls oedometer_to(int axis, double axial_stress) {
  Controls c = no_strain();
  c[std::size_t(axis)] = stress_to(axis, axial_stress);
  return c;
}

Controls triaxial(TriaxialDrainage drainage, int axis, Course a) {
  Controls c = oedometer(axis, a);
  const auto sides = sides_of(axis);
  switch (drainage) {
    case TriaxialDrainage::undrained:
      for (int i : sides) c[std::size_t(i)] = strain_control(i, -a.rate / 2, -a.acceleration / 2);
      break;
    case TriaxialDrainage::drained:
      for (int i : sides) c[std::size_t(i)] = held_stress(i);
      break;
    case TriaxialDrainage::constant_p: {  // constant sum of the normal stresses; equal lateral strains
      Control &mean = c[std::size_t(sides[0])], &even = c[std::size_t(sides[1])];
      mean = held_stress(sides[0]);
      mean.of_stress = {1, 1, 1, 0, 0, 0};
      mean.name = "mean stress (times 3)";
      even.of_strain[std::size_t(sides[0])] = -1;
      break;
    }
  }
  return c;
}

Controls triaxial_to(TriaxialDrainage drainage, int axis, double axial_stress) {
  Controls c = triaxial(drainage, axis, {});
  c[std::size_t(axis)] = stress_to(axis, axial_stress);
  if (drainage == TriaxialDrainage::undrained)  // constant volume at any axial strain
    for (int i : sides_of(axis)) c[std::size_t(i)].of_strain[std::size_t(axis)] = 0.5;
  return c;
}

Controls triaxial_to_q(TriaxialDrainage drainage, int axis, double q) {
  Controls c = triaxial_to(drainage, axis, q);
  for (int i : sides_of(axis)) c[std::size_t(axis)].of_stress[std::size_t(i)] = -0.5;
  c[std::size_t(axis)].name = "q";
  return c;
}

Controls simple_shear(ShearDrainage drainage, int plane, Course g) {
  Controls c = no_strain();
  c[3 + std::size_t(plane)] = strain_control(3 + plane, g.rate, g.acceleration);
  // Planes of shear xy are normal to y, those of yz to z, those of zx to x.
  const int normal = (plane + 1) % 3;
  if (drainage == ShearDrainage::constant_normal_stress) c[std::size_t(normal)] = held_stress(normal);
  return c;
}

Controls simple_shear_to(ShearDrainage drainage, int plane, double shear_stress) {
  Controls c = simple_shear(drainage, plane, {});
  c[3 + std::size_t(plane)] = stress_to(3 + plane, shear_stress);
  return c;
}

bool controls_a_stress(const Segment& segment) {
  return std::any_of(segment.controls.begin(), segment.controls.end(), [](const Control& c) {
    return std::any_of(c.of_stress.begin(), c.of_stress.end(), [](double s) { return s != 0; });
  });
}

std::string fault_of_strains(const Segment& segment) {
  const auto fault = [&](int i, double strain) -> std::string {
    const double most = i < 3 ? most_normal_strain : most_shear_strain;
    if (std::abs(strain) <= most) return "";
    return fmt::format("changes the strain {} by {:.3g}; at most {:g} is possible", component_names[i], strain, most);
  };
  std::array<double, 6> of_table{};
  for (std::size_t k = 1; k < segment.history.size(); ++k)
    for (std::size_t i = 0; i < 6; ++i) {
      const RateInstant &a = segment.history[k - 1], &b = segment.history[k];
      of_table[i] += 0.5 * (b.time - a.time) * (std::abs(a.rate[i]) + std::abs(b.rate[i]));
    }
  for (std::size_t i = 0; i < 6; ++i) {
    const Control& c = segment.controls[i];
    const bool of_stress = std::any_of(c.of_stress.begin(), c.of_stress.end(), [](double x) { return x != 0; });
    if (of_stress) continue;
    const double T = segment.duration;
    const double strain =
        segment.history.empty() ? std::max(std::abs(c.rate * T), std::abs(0.5 * c.acceleration * T * T)) : of_table[i];
    if (std::string text = fault(int(i), strain); !text.empty()) return text;
  }
  return "";
}

std::vector<Segment> between_stresses(const Segment& segment, Measure measure, std::array<double, 2> values, int cycles,
                                      double rate, double longest, const std::function<Controls(Course)>& controls_at) {
  std::vector<Segment> segments;
  for (int way = 0; way < 2 * cycles; ++way) {
    const int here = way % 2, up = (values[std::size_t(here)] > values[std::size_t(1 - here)]) ? 1 : -1;
    Segment part = segment;
    part.rows = std::max(1, int(std::lround(segment.rows / (2.0 * cycles))));
    part.duration = longest / rate;
    part.controls = controls_at({up * rate, 0});
    part.stops.push_back({measure, values[std::size_t(here)], up, true});
    segments.push_back(std::move(part));
  }
  return segments;
}

std::vector<Segment> between_turning_points(const Segment& segment, const std::vector<double>& turning_points,
                                            const std::function<Controls(Course)>& controls_at) {
  double length = 0, last = 0;
  for (double turn : turning_points) {
    length += std::abs(turn - last);
    last = turn;
  }
  std::vector<Segment> segments;
  last = 0;
  for (double turn : turning_points) {
    const double share = length > 0 ? std::abs(turn - last) / length : 0;
    if (share > 0) {
      Segment part = segment;
      part.duration = segment.duration * share;
      part.rows = std::max(1, int(std::lround(segment.rows * share)));
      part.controls = controls_at({(turn - last) / part.duration, 0});
      segments.push_back(part);
    }
    last = turn;
  }
  return segments;
}

}  // namespace talus
