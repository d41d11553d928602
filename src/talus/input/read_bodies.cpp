#include <fmt/format.h>
#include <fmt/ranges.h>

#include "talus/case/material.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

constexpr Text material_of_body{"material", "name of the body's material"};
constexpr Option lattice{"lattice", "arrangement of the particles at the start", lattice_choices};
constexpr WholeNumber seed{keys::seed};
constexpr Numbers velocity{{"velocity", "m/s", {}, "velocity at the start"}, one_per_axis};
constexpr Parameter spin{"angular_velocity",
                         "rad/s",
                         {},
                         "angular velocity about the centre of mass at the start; in 2D positive from x to y"};
constexpr Numbers spin_in_3d{spin, 3};

constexpr const char* normal_components[] = {"xx", "yy", "zz"};
constexpr const char* shear_components[] = {"xy", "yz", "zx"};
constexpr Parameter normal_stress(int k) {
  return {normal_components[k], "Pa", {}, "normal stress, tension positive, the same everywhere"};
}
constexpr Parameter shear_stress(int k) { return {shear_components[k], "Pa", {}, "shear stress, the same everywhere"}; }
const Declaration& given_stress_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> components;
    for (int k = 0; k < 3; ++k) components.push_back(required(normal_stress(k)));
    for (int k = 0; k < 3; ++k) components.push_back(optional(shear_stress(k)));
    return Declaration("a stress", std::move(components));
  }();
  return d;
}
constexpr Option initial_stress{
    "initial_stress", "stress at the start; or a table of its components, { xx = \"-1 kPa\", yy = ..., zz = ... }",
    initial_stress_choices};
constexpr Table given_stress{initial_stress.key, initial_stress.meaning, given_stress_declaration};

/// The number of the material that a body names; -1 if there is none of this name.
int read_material_of(Section& s, const Case& case_) {
  const std::string name = s.text(material_of_body);
  int material = -1;
  std::vector<std::string_view> names;
  for (std::size_t m = 0; m < case_.materials.size(); ++m) {
    names.push_back(case_.materials[m].name);
    if (case_.materials[m].name == name) material = int(m);
  }
  if (material < 0 && !name.empty())
    s.complain("material", names.empty()
                               ? "is not among the materials"
                               : fmt::format("is not among the materials; there is {}", fmt::join(names, ", ")));
  return material;
}

/// Particles listed in a file.
void read_listed(Section& s, const Case& case_, const std::string& folder, BodySpec& body) {
  const std::optional<double> spacing = s.optional_number(keys::spacing);
  Section points = s.section(keys::points);
  body.region = read_points(points, case_.dim, folder, spacing);
  if (s.has("lattice")) s.complain("lattice", "has no meaning for listed points");
}

/// A layer on the terrain.
void read_released(Section& s, Case& case_, const std::string& folder, const std::optional<TerrainCrop>& crop,
                   BodySpec& body) {
  body.spacing = s.number(keys::spacing);
  Section release = s.section(keys::release);
  body.region = read_release(release, case_, folder, body.spacing, crop);
  if (s.has("lattice")) s.complain("lattice", "has no meaning for a release, whose particles follow the ground");
}

/// A shape, and the lattice of particles that fills it.
void read_filled(Section& s, const Case& case_, const std::string& folder, BodySpec& body) {
  if (s.has("image")) {
    Section image = s.section(keys::image);
    body.region = read_image(image, folder);
  } else {
    body.region = read_shape(s, case_.dim);
  }
  body.spacing = s.number(keys::spacing);
  body.lattice = Lattice(s.choice(lattice));
  if (body.lattice != Lattice::blue_noise)
    body.scatter = s.number(keys::scatter, BodySpec{}.scatter);
  else if (s.has("scatter"))
    s.complain("scatter", "has no meaning with lattice = \"blue_noise\": it has no rows");
  if (body.scatter > 0 || body.lattice == Lattice::blue_noise)
    body.seed = s.whole_number(seed, BodySpec{}.seed);
  else if (s.has("seed"))
    s.complain("seed", "has no meaning without `scatter` or lattice = \"blue_noise\"");
}

void read_velocity(Section& s, const Case& case_, BodySpec& body) {
  if (s.has("velocity")) body.velocity = vector_of(s.numbers(velocity, case_.dim));
  if (!s.has("angular_velocity")) return;
  if (case_.dim == 2)
    body.angular_velocity[2] = s.number(spin);
  else
    body.angular_velocity = vector_of(s.numbers(spin_in_3d));
}

/// A word, or the components of a stress that is the same everywhere.
void read_initial_stress(Section& s, const Case& case_, BodySpec& body) {
  if (!s.is_table(initial_stress.key)) {
    s.required_choice(initial_stress);
    body.initial_stress = s.is_text(initial_stress.key, "k0") ? InitialStress::k0 : InitialStress::zero;
    return;
  }
  body.initial_stress = InitialStress::given;
  Section t = s.section(given_stress);
  for (int k = 0; k < 3; ++k) body.given_stress[k] = t.number(normal_stress(k));
  for (int k = 0; k < (case_.dim == 3 ? 3 : 1); ++k) body.given_stress[3 + k] = t.number(shear_stress(k), 0.0);
  t.close();
}

BodySpec read_body(Section& s, Case& case_, const std::string& folder, const std::optional<TerrainCrop>& crop) {
  BodySpec body;
  body.material = read_material_of(s, case_);
  s.expect_one_of();
  if (s.has("points"))
    read_listed(s, case_, folder, body);
  else if (s.has("release"))
    read_released(s, case_, folder, crop, body);
  else
    read_filled(s, case_, folder, body);
  read_velocity(s, case_, body);
  if (body.material >= 0)
    if (const auto range = void_ratios_of(case_.materials[std::size_t(body.material)].law))
      body.void_ratio = s.number(keys::void_ratio(*range));
  read_initial_stress(s, case_, body);
  s.close();
  return body;
}

}  // namespace

const Declaration& body_declaration() {
  static const Declaration d = [] {
    std::vector<Entry> all = {required(material_of_body),
                              optional(keys::box),
                              optional(keys::cylinder),
                              optional(keys::polygon),
                              optional(keys::image),
                              optional(keys::points),
                              optional(keys::release),
                              depends(keys::spacing),
                              optional(lattice),
                              optional(keys::scatter),
                              optional(seed),
                              optional(velocity),
                              optional(spin),
                              optional(spin_in_3d),
                              required(initial_stress),
                              required(given_stress)};
    Laws::for_each([&]<class Law>() {
      if constexpr (HasVoidRatio<Law>) all.push_back(depends(keys::void_ratio(Law::void_ratios)));
    });
    return Declaration("a body", std::move(all), {"box", "cylinder", "polygon", "image", "points", "release"});
  }();
  return d;
}

void read_bodies(Section& root, Case& case_, const std::string& folder, const std::optional<TerrainCrop>& crop) {
  for (auto& [name, s] : root.named_sections(keys::bodies)) {
    case_.bodies.push_back(read_body(s, case_, folder, crop));
    case_.bodies.back().name = name;
  }
}

}  // namespace talus
