#include "talus/case/loading.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace talus {

namespace {

constexpr double most_rows = 1e7;  ///< of all segments

/// The axes across another one.
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
    case TriaxialDrainage::constant_p: {  // the sum of the normal stresses is held, and the lateral strains stay equal
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
  if (drainage == TriaxialDrainage::undrained)  // constant volume, whatever the axial strain turns out to be
    for (int i : sides_of(axis)) c[std::size_t(i)].of_strain[std::size_t(axis)] = 0.5;
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
