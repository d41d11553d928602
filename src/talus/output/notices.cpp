#include "talus/output/notices.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>

#include "talus/case/defaults.hpp"

namespace talus {

std::string notice_of_stiffness(const Numerics& numerics) {
  const double factor = numerics.stiffness_factor;
  if (factor == 1) return "";
  return fmt::format(
      "The elastic stiffness is scaled by {:.4g} (`stiffness_factor`): time steps limited by waves are about {:.2g} "
      "times "
      "longer; waves travel {:.2g} times slower, and elastic settlements are {:.3g} times as large. Compare with one "
      "run "
      "with stiffness_factor = 1.",
      factor, 1 / std::sqrt(factor), 1 / std::sqrt(factor), 1 / factor);
}

std::string notice_of_preset(const Case& case_) {
  const Numerics& n = case_.numerics;
  if (n.preset != Preset::paper) return "";
  std::vector<std::string> departures;
  const auto note = [&](bool departs, const std::string& text) {
    if (departs) departures.push_back(text);
  };
  note(n.shape_function != ShapeFunction::linear, "other shapes");
  note(n.transfer != Transfer::flip || n.flip_share != 1, "another transfer");
  note(n.order != Order::usf, "another order");
  note(n.integration.scheme != Integrator::forward_euler, "another integrator");
  note(n.average_pressure || n.f_bar, "averaging over cells");
  note(bulk_viscosity_of(n) > 0, "bulk viscosity");
  note(n.particle_shifting, "particle shifting");
  note(n.particle_splitting != Splitting::none, "particle splitting");
  note(n.rest_tolerance > 0, "rest of tiles");
  note(n.dt != 1e-6, fmt::format("dt = {:.4g} s", n.dt.value_or(0)));
  for (const Material& m : case_.materials)
    std::visit(
        [&]<class Law>(const Law& law) {
          if constexpr (requires { law.collisional.form; })
            note(law.collisional.form != CollisionalForm::rate, "another collisional form of " + m.name);
          else if constexpr (requires { law.form; })
            note(law.form != CollisionalForm::rate, "another collisional form of " + m.name);
        },
        m.law);
  std::string text =
      "preset = \"paper\" is the paper's scheme as printed. Use it for comparison only: the pressure of particles "
      "scatters, "
      "collisional stress remains at rest, and stress jumps where particles cross cells (docs/numerics.md).";
  if (!departures.empty()) text += fmt::format(" This case departs from it: {}.", fmt::join(departures, ", "));
  return text;
}

std::string notice_of_symmetry(const Case& case_) {
  int planes = 0;
  for (const Wall& wall : case_.walls) planes += wall.kind == WallKind::symmetry;
  if (planes == 0) return "";
  return fmt::format("{} plane{} of symmetry: masses, energies and impulses are those of the computed part.", planes,
                     planes == 1 ? "" : "s");
}

std::string notice_of_outflow(const RunSummary& run) {
  const Ledger& l = run.ledger;
  if (l.outflow.mass == 0) return "";
  std::vector<std::string> ways;
  if (const std::vector<OutflowOnMap>& places = run.outflow; !places.empty()) {
    // The record has all. Single particles that lost contact go far: places of a ten thousandth are not named.
    constexpr std::size_t most = 4;
    const auto is_small = [](const OutflowOnMap& place) { return place.share < 1e-4; };
    const std::size_t n_large =
        std::max<std::size_t>(1, places.size() - std::size_t(std::ranges::count_if(places, is_small)));
    const std::size_t n = std::min(most, n_large), rest = places.size() - n;
    for (std::size_t i = 0; i < n; ++i) ways.push_back(in_words(places[i]));
    if (rest > 0)
      ways.push_back(fmt::format("and {} further place{}{}", rest, rest == 1 ? "" : "s",
                                 n == n_large ? ", less than 0.01 % each" : ""));
    return fmt::format(
        "{:.3g} kg, {:.3g} % of the mass, have left the domain: {}. Runout and deposit are those of the material in "
        "the domain.",
        l.outflow.mass, 100 * l.outflow.mass / (l.outflow.mass + l.mass), fmt::join(ways, "; "));
  }
  for (std::size_t way = 0; way < l.outflow.mass_through.size(); ++way)
    if (const double mass = l.outflow.mass_through[way]; mass > 0)
      ways.push_back(fmt::format("{} {:.3g} %",
                                 way == unknown_ground ? "over ground without heights" : side_choices[way].word,
                                 100 * mass / l.outflow.mass));
  return fmt::format(
      "{:.3g} kg, {:.3g} % of the mass, have left through `outflow` sides ({}). Fronts and heights are those of the "
      "material in the domain.",
      l.outflow.mass, 100 * l.outflow.mass / (l.outflow.mass + l.mass), fmt::join(ways, ", "));
}

std::string in_words(const StepTally& t) {
  const auto length = [](double seconds) { return fmt::format("{:.3g} us", 1e6 * seconds); };
  if (t.n() == 0) return "no steps";
  std::string text = fmt::format("{} steps of {} to {}, {} on average; limited by", t.n(), length(t.shortest),
                                 length(t.longest), length(t.mean()));
  std::string separator = " ";
  for (int i = 0; i < n_bounds; ++i) {
    if (t.held[i] == 0) continue;
    std::string name(bound_names[i].word);
    std::replace(name.begin(), name.end(), '_', ' ');
    text += fmt::format("{}{} {:.1f} %", separator, name, 100 * t.share(Bound(i)));
    separator = ", ";
    if (Bound(i) == Bound::waves_and_motion)
      text += fmt::format(" (wave speed {:.3g} m/s, particle speed {:.2g} m/s)", t.mean_of(t.wave_speed),
                          t.mean_of(t.speed));
  }
  if (t.mean_rest() > 0) text += fmt::format("; {:.0f} % of the particles at rest, left out", 100 * t.mean_rest());
  return text;
}

std::vector<std::string> warnings_of(const Case& case_, const RunSummary& run) {
  std::vector<std::string> warnings;
  if (const std::string notice = notice_of_stiffness(case_.numerics); !notice.empty()) warnings.push_back(notice);
  if (const std::string notice = notice_of_preset(case_); !notice.empty()) warnings.push_back(notice);
  const Ledger& l = run.ledger;
  // Shares of a negligible energy mean nothing: ground that was not lowered by a hundredth of a cell, on average, is at
  // rest.
  const double weight = l.mass * std::hypot(case_.gravity[0], case_.gravity[1], case_.gravity[2]);
  const double energy = l.turnover > 0.01 * case_.cell * weight ? l.turnover : 0;
  if (depends_on_step(case_.numerics))
    warnings.push_back(fmt::format(
        "The result depends on the time step by construction: {} removes a share of the velocity fluctuations in every "
        "step, however short. Use transfer = \"affine_tau\", or compare runs with different `cfl`.",
        case_.numerics.transfer == Transfer::flip
            ? fmt::format("`flip_share` = {:.4g}", case_.numerics.flip_share)
            : fmt::format("transfer = \"{}\"", word_of(case_.numerics.transfer))));
  if (energy > 0 && std::abs(l.error()) > most_missed * energy)
    warnings.push_back(fmt::format(
        "The energy balance has an error of {:.2g} % of the energy released (limit 1 %). Use a smaller `cfl`.",
        100 * std::abs(l.error()) / energy));
  if (energy > 0 && l.method() > 0.25 * energy)
    warnings.push_back(fmt::format(
        "Numerical dissipation is {:.0f} % of the energy released (limit 25 %). Use smaller cells or a longer `tau`.",
        100 * l.method() / energy));
  if (energy > 0 && l.method() < -most_missed * energy)
    warnings.push_back(fmt::format(
        "The method created {:.1f} % of the energy released: velocity fluctuations below the cell size grow. "
        "Use {}a smoother `shape`.",
        -100 * l.method() / energy,
        case_.numerics.transfer == Transfer::affine_tau ? "" : "transfer = \"affine_tau\" or "));
  if (energy > 0 && l.returned > most_returned * energy)
    warnings.push_back(fmt::format(
        "Collisions returned {:.1f} % of the energy released, where the flow extends: the tensor D.D is not "
        "dissipative there. Use dispersive = \"isotropic\", or the law `granular_rate`.",
        100 * l.returned / energy));
  if (run.noise && std::max(run.noise->in_time, run.noise->within_cells) > most_noise)
    warnings.push_back(fmt::format(
        "Pressure in flow is noisy: it fluctuates by {:.0f} % of its mean in time and by {:.0f} % among the particles "
        "of a "
        "cell. Means over time remain valid; single values do not. {}",
        100 * run.noise->in_time, 100 * run.noise->within_cells,
        bulk_viscosity_of(case_.numerics) > 0 ? "Use more particles per cell (smaller `spacing`) or smaller cells."
                                              : "Use bulk_viscosity = 0.4 with order = \"usf\"."));
  if (l.n_unconverged > 0)
    warnings.push_back(
        fmt::format("{} stress updates did not converge. Use a smaller `cfl`, or integrator = \"modified_euler\".",
                    l.n_unconverged));
  const bool moves = l.kinetic > 0.01 * l.turnover;  // and grains that fly are apart, as they should be
  const double n_particles = double(run.n_particles + l.n_split - l.n_merged);
  if (!moves && double(l.n_separated) > 0.2 * n_particles)
    warnings.push_back(
        fmt::format("{:.0f} % of the particles carry no stress at the end (limit 20 %). Use more particles per cell "
                    "(smaller `spacing`).",
                    100.0 * double(l.n_separated) / n_particles));
  if (energy > 0 && l.plastic > 0 && moves)
    warnings.push_back("The material still moves at the end. Use a later `end` to get the deposit.");
  if (run.thalweg && run.thalweg->passes_end)
    warnings.push_back(
        "The flow has passed the end of the thalweg: runout and length are lower bounds. Use a longer thalweg.");
  if (run.thalweg && run.thalweg->starts_above)
    warnings.push_back(
        "The release begins above the thalweg: drop and length are lower bounds. Begin the thalweg at the top of the "
        "release.");
  return warnings;
}

}  // namespace talus
