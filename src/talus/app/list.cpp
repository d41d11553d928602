#include <fmt/format.h>

#include "talus/app/commands.hpp"
#include "talus/base/units.hpp"
#include "talus/case/case.hpp"
#include "talus/input/reader.hpp"

namespace talus {

namespace {

void print_choices(const char* title, std::span<const Choice> choices) {
  fmt::print("\n{}\n", title);
  for (const Choice& c : choices)
    fmt::print("  {:<16} {}{}\n", c.word, c.meaning, &c == choices.data() ? " [default]" : "");
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
  fmt::print("    tells: ");
  std::string quantities;
  for (const auto& q : Law::quantities())
    quantities += fmt::format("{}{}{}", quantities.empty() ? "" : ", ", q.name,
                              q.unit == "1" ? "" : fmt::format(" [{}]", q.unit));
  fmt::print("{}\n", quantities);
}

}  // namespace

int list_everything() {
  fmt::print("Laws (material.NAME.law)\n");
  Laws::for_each([]<class Law>() {
    if (is_named<Law>) print_law<Law>();
  });
  print_choices("Presets (numerics.preset)", preset_choices);
  print_choices("Shape functions (numerics.shape)", shape_function_choices);
  print_choices("Transfers (numerics.transfer)", transfer_choices);
  print_choices("Order (numerics.order)", order_choices);
  print_choices("Integrators (numerics.integrator; driver.integrator of element tests)", integrator_choices);
  print_choices("Walls (domain.walls.x_min, x_max, y_min, ...)", wall_choices);
  fmt::print("\nSurfaces of solids (solid.NAME.contact)\n");
  for (const Choice& c : contact_choices) fmt::print("  {:<16} {}\n", c.word, c.meaning);
  print_choices("Initial stress (body.NAME.initial_stress)", initial_stress_choices);
  print_choices("Sides of bodies (load.NAME.side)", side_choices);
  print_choices("Lattice of particles (body.NAME.lattice)", lattice_choices);
  fmt::print("\nQuantities told by every law\n");
  for (const Quantity& q : common_quantities)
    fmt::print("  {:<16} {:<7} {}\n", q.name, q.unit == "1" ? "-" : q.unit, q.meaning);
  return 0;
}

}  // namespace talus
