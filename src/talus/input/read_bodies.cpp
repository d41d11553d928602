#include <fmt/format.h>
#include <fmt/ranges.h>

#include "talus/case/keys.hpp"
#include "talus/case/material.hpp"
#include "talus/input/sections.hpp"

namespace talus {

namespace {

/// The number of the material that a body names; -1 if there is none of this name.
int read_material_of(Section& s, const Case& case_) {
  const std::string name = s.text("material", "name of the body's material");
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
  Section points = s.section("points", "particles listed in a file");
  body.region = read_points(points, case_.dim, folder, spacing);
  if (s.has("lattice")) s.complain("lattice", "has no meaning for listed points");
}

/// A shape, and the lattice of particles that fills it.
void read_filled(Section& s, const Case& case_, const std::string& folder, BodySpec& body) {
  if (s.has("image")) {
    Section image = s.section("image", "the dark pixels of a picture");
    body.region = read_image(image, folder);
  } else {
    body.region = read_shape(s, case_.dim);
  }
  body.spacing = s.number(keys::spacing);
  body.lattice = Lattice(s.choice({"lattice", "where the particles stand", lattice_choices}));
  body.scatter = s.number(keys::scatter, BodySpec{}.scatter);
  if (body.scatter > 0)
    body.seed = s.whole_number(keys::seed, BodySpec{}.seed);
  else if (s.has("seed"))
    s.complain("seed", "has no meaning without `scatter`");
}

void read_velocity(Section& s, const Case& case_, BodySpec& body) {
  if (s.has("velocity"))
    body.velocity = vector_of(s.numbers({"velocity", "m/s", {}, "velocity at the start"}, case_.dim));
  if (!s.has("angular_velocity")) return;
  const Parameter spin{
      "angular_velocity", "rad/s", {}, "turning about the middle of its mass at the start; in 2D positive from x to y"};
  if (case_.dim == 2)
    body.angular_velocity[2] = s.number(spin);
  else
    body.angular_velocity = vector_of(s.numbers(spin, 3));
}

/// A word, or the components of a stress that is the same everywhere.
void read_initial_stress(Section& s, const Case& case_, BodySpec& body) {
  const Option option{"initial_stress",
                      "stress at the start; or a table of its components, { xx = \"-1 kPa\", yy = ..., zz = ... }",
                      initial_stress_choices};
  if (!s.is_table(option.key)) {
    s.required_choice(option);
    body.initial_stress = s.is_text(option.key, "k0") ? InitialStress::k0 : InitialStress::zero;
    return;
  }
  body.initial_stress = InitialStress::given;
  Section t = s.section(option.key, option.meaning);
  static constexpr const char* normal[] = {"xx", "yy", "zz"};
  static constexpr const char* shear[] = {"xy", "yz", "zx"};
  for (int k = 0; k < 3; ++k)
    body.given_stress[k] = t.number({normal[k], "Pa", {}, "normal stress, tension positive, the same everywhere"});
  for (int k = 0; k < (case_.dim == 3 ? 3 : 1); ++k)
    body.given_stress[3 + k] = t.number({shear[k], "Pa", {}, "shear stress, the same everywhere"}, 0.0);
  t.close("a stress");
}

BodySpec read_body(Section& s, const Case& case_, const std::string& folder) {
  BodySpec body;
  body.material = read_material_of(s, case_);
  expect_one_of(s, {"box", "cylinder", "polygon", "image", "points"});
  if (s.has("points"))
    read_listed(s, case_, folder, body);
  else
    read_filled(s, case_, folder, body);
  read_velocity(s, case_, body);
  if (body.material >= 0)
    if (const auto range = void_ratios_of(case_.materials[std::size_t(body.material)].law))
      body.void_ratio = s.number(keys::void_ratio(*range));
  read_initial_stress(s, case_, body);
  s.close("a body");
  return body;
}

}  // namespace

void read_bodies(Section& root, Case& case_, const std::string& folder) {
  for (auto& [name, s] : root.named_sections("body", "the bodies, each a region filled with particles")) {
    case_.bodies.push_back(read_body(s, case_, folder));
    case_.bodies.back().name = name;
  }
}

}  // namespace talus
