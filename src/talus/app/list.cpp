#include <fmt/format.h>

#include "talus/app/commands.hpp"
#include "talus/base/units.hpp"
#include "talus/case/case.hpp"
#include "talus/case/defaults.hpp"
#include "talus/input/reader.hpp"

namespace talus {

namespace {

constexpr int no_default = -1;

/// Prints the words of a key. `by_default`: number of the word that a case takes without the key.
void print_choices(const char* title, std::span<const Choice> choices, int by_default) {
  fmt::print("\n{}\n", title);
  for (std::size_t i = 0; i < choices.size(); ++i)
    fmt::print("  {:<16} {}{}\n", choices[i].word, choices[i].meaning, int(i) == by_default ? " [default]" : "");
}

template <class Law>
void print_law() {
  fmt::print("\n  {}: {}\n", Law::name, Law::meaning);
  for (const auto& p : Law::parameters())
    fmt::print("    {:<18} {:<7} {:<42} {}\n", p.key,
               p.unit == "1"     ? "-"
               : p.unit == "rad" ? "deg"
                                 : p.unit,
               in_words(p.range, p.unit), p.meaning);
  for (const auto& o : Law::options()) {
    std::string words;
    for (const Choice& c : o.choices) words += fmt::format("{}{}", words.empty() ? "" : " | ", c.word);
    fmt::print("    {:<18} {:<50} {}\n", o.key, words, o.meaning);
  }
  fmt::print("    outputs: ");
  std::string quantities;
  for (const auto& q : Law::quantities())
    quantities += fmt::format("{}{}{}", quantities.empty() ? "" : ", ", q.name,
                              q.unit == "1" ? "" : fmt::format(" [{}]", q.unit));
  fmt::print("{}\n", quantities);
}

}  // namespace

int list_everything() {
  const Numerics numerics = numerics_of(Preset::standard);
  fmt::print("Laws (material.NAME.law)\n");
  Laws::for_each([]<class Law>() {
    if (is_named<Law>) print_law<Law>();
  });
  print_choices("Presets (numerics.preset)", preset_choices, int(numerics.preset));
  print_choices("Shape functions (numerics.shape)", shape_function_choices, int(numerics.shape_function));
  print_choices("Transfers (numerics.transfer)", transfer_choices, int(numerics.transfer));
  print_choices("Order (numerics.order)", order_choices, int(numerics.order));
  print_choices("Splitting (numerics.particle_splitting)", splitting_choices, int(numerics.particle_splitting));
  print_choices("Integrators (numerics.integrator; driver.integrator of element tests)", integrator_choices,
                int(numerics.integration.scheme));
  print_choices("Walls (domain.walls.x_min, x_max, y_min, ...)", wall_choices, int(Wall().kind));
  print_choices("Surfaces of solids (solid.NAME.contact)", contact_choices, no_default);
  print_choices("Initial stress (body.NAME.initial_stress)", initial_stress_choices, no_default);
  print_choices("Sides of bodies (load.NAME.side)", side_choices, no_default);
  print_choices("Lattice of particles (body.NAME.lattice)", lattice_choices, int(BodySpec{}.lattice));
  fmt::print("\nQuantities of every law\n");
  for (const Quantity& q : common_quantities)
    fmt::print("  {:<16} {:<7} {}\n", q.name, q.unit == "1" ? "-" : q.unit, q.meaning);
  return 0;
}

}  // namespace talus
