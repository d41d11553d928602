#pragma once
/// Failures of a run: particle, position, time and state.

#include <fmt/format.h>

#include <cmath>
#include <string>

#include "talus/base/error.hpp"
#include "talus/mpm/ledger.hpp"
#include "talus/mpm/model.hpp"

namespace talus {

/// The particle that a message names, among those of all owners.
struct Culprit {
  long id = -1;
  std::string text;      ///< its description
  double tile = 0;       ///< number of its tile in the run
  std::size_t body = 0;  ///< its body's number

  /// That of all owners which a single owner finds first: body by body, tile by tile.
  static Culprit first_of(Backend& backend, const Culprit& own) {
    Message place;
    if (!own.text.empty()) place = {double(own.body), own.tile};
    Message first;
    for (const Message& other : backend.gather(place))
      if (!other.empty() && (first.empty() || other < first)) first = other;
    const bool is_own = !place.empty() && place == first;  // a tile has one owner
    const std::string all = gather(backend, is_own ? fmt::format("{}\n{}", own.id, own.text) : "");
    if (all.empty()) return {};
    const auto end = all.find('\n');
    return {std::stol(all.substr(0, end)), all.substr(end + 1)};
  }
};

/// A particle of this owner; `body`: the number of its body.
template <int Dim, class Shape>
Culprit culprit_at(const Model<Dim, Shape>& m, std::size_t body, int particle) {
  const Body<Dim>& its = m.bodies[body];
  return {its.particles.id(particle), describe<Dim>(its, particle),
          tile_numbers<Dim>(its, m.halo, m.backend)[std::size_t(particle)], body};
}

/// Throws a RunError with the state of the first particle for which `is_bad` is true.
template <int Dim, class Shape, class F>
[[noreturn]] void stop(const Model<Dim, Shape>& m, const Ledger& ledger, const std::string& fault, F is_bad,
                       const std::string& advice = "") {
  for (std::size_t b = 0; b < m.bodies.size(); ++b) {
    const Body<Dim>& body = m.bodies[b];
    Culprit own;
    for (int i = 0; i < body.particles.size() && own.text.empty(); ++i)
      if (is_bad(body, i)) own = culprit_at(m, b, i);
    const Culprit first = Culprit::first_of(m.backend, own);
    if (first.text.empty()) continue;
    throw RunError(fmt::format("{}: at t = {:.6g} s, step {}, dt = {:.3g} s\n{}{}", fault, ledger.time, ledger.step,
                               ledger.dt, first.text, advice),
                   first.id);
  }
  throw RunError(fault);
}

/// Explanation of a failure if the material is too soft: its weight strains a cell by a tenth or more. The strain is
/// rho g h/(rho c^2), with the cell size h and the wave speed c. Otherwise empty.
template <int Dim, class Shape>
std::string softness(const Model<Dim, Shape>& m, double wave_speed) {
  const double acceleration = std::sqrt(dot(m.gravity, m.gravity));
  const double strain = acceleration * m.domain.h / (wave_speed * wave_speed);
  if (!(strain > 0.1)) return "";
  return fmt::format(
      "Wave speed {:.3g} m/s, gravity {:.3g} m/s2: the weight of one cell ({:.3g} m) strains it by {:.3g} %, and at "
      "most a few per cent can be computed. Use a stiffer material or less gravity.\n",
      wave_speed, acceleration, m.domain.h, 100 * strain);
}

template <int Dim, class Shape>
std::string reason_not_finite(const Model<Dim, Shape>& m, double wave_speed) {
  const std::string soft = softness(m, wave_speed);
  if (!soft.empty()) return soft;
  return fmt::format(
      "Wave speed {:.3g} m/s, gravity {:.3g} m/s2. Remove a fixed `dt` or use a smaller `cfl`; if the error persists, "
      "report it as a bug.\n",
      wave_speed, std::sqrt(dot(m.gravity, m.gravity)));
}

/// `wave_speed`: the largest before the step.
template <int Dim, class Shape>
[[noreturn]] void stop_outside(const Model<Dim, Shape>& m, const Ledger& ledger, double wave_speed) {
  const auto is_not_finite = [](const Body<Dim>& body, int i) {
    for (int a = 0; a < Dim; ++a)
      if (!std::isfinite(body.particles.position(a)[i])) return true;
    return false;
  };
  double n_of_owner = 0;
  for (const auto& body : m.bodies)
    for (int i = 0; i < body.particles.size(); ++i) n_of_owner += is_not_finite(body, i);
  double n = 0;
  for (const Message& of_one : m.backend.gather({n_of_owner})) n += of_one[0];
  if (n > 0) stop(m, ledger, "the state is not finite", is_not_finite, reason_not_finite(m, wave_speed));
  const std::string soft = softness(m, wave_speed);
  stop(
      m, ledger, "a particle has left the domain",
      [&](const Body<Dim>& body, int i) {
        return !m.domain.contains(m.domain.in_cells(body.particles.view().places(i, 1)));
      },
      soft.empty() ? "Use a larger domain, or a side of kind `outflow`, where material may leave.\n" : soft);
}

template <int Dim, class Shape>
[[noreturn]] void stop_at_bad_stress(const Model<Dim, Shape>& m, const Ledger& ledger, double wave_speed) {
  stop(
      m, ledger, "the stress is not finite",
      [](const Body<Dim>& body, int i) {
        for (int k = 0; k < body.particles.memory().n_state; ++k)
          if (!std::isfinite(body.particles.state(k)[i])) return true;
        return false;
      },
      reason_not_finite(m, wave_speed));
}

/// Names the particle with the fastest waves, or the fastest particle, whichever limits the step more.
template <int Dim, class Shape>
[[noreturn]] void stop_at_short_step(const Model<Dim, Shape>& m, const Ledger& ledger, double dt, double wave_speed,
                                     double viscosity) {
  std::size_t at = 0;
  int particle = -1;
  double most = -1;
  for (std::size_t b = 0; b < m.bodies.size(); ++b) {
    const Body<Dim>& body = m.bodies[b];
    const Particles<Dim>& p = body.particles;
    const auto blame = [&](double speed, int i) {
      if (!(speed > most)) return;
      most = speed;
      at = b;
      particle = i;
    };
    const FastestWave wave = fastest_wave<Dim>(body, m.numerics.integration);
    if (p.size() > 0) blame(wave.speed, wave.particle);
    for (int i = 0; i < p.size(); ++i) {
      double speed2 = 0;
      for (int a = 0; a < Dim; ++a) speed2 += p.velocity(a)[i] * p.velocity(a)[i];
      blame(1.3 * std::sqrt(speed2), i);
    }
  }
  double most_of_all = most;
  for (const Message& other : m.backend.gather({most})) most_of_all = std::max(most_of_all, other[0]);
  Culprit own;
  if (particle >= 0 && most == most_of_all) own = culprit_at(m, at, particle);
  const Culprit first = Culprit::first_of(m.backend, own);
  const std::string text = fmt::format(
      "the time step has collapsed to {:.3g} s at t = {:.6g} s, step {}: wave speed {:.4g} m/s, "
      "fastest particle {:.4g} m/s, "
      "viscosity {:.4g} m2/s",
      dt, ledger.time, ledger.step, wave_speed, ledger.max_speed, viscosity);
  if (first.text.empty()) throw RunError(text);
  throw RunError(text + "\n" + first.text, first.id);
}

}  // namespace talus
