#pragma once
/// Linear elasticity with the cone of Drucker and Prager (1952, Q. Appl. Math. 10:157): a baseline.
///
///   f = q - M (p + c cot phi) <= 0        g = q - M_psi p
///
/// M and M_psi give the cone the friction angle phi and the dilatancy angle psi of Mohr and Coulomb in one mode of
/// failure (de Souza Neto, Peric and Owen 2008, Computational Methods for Plasticity, Sec. 6.4.4):
///
///   compression    M = 6 sin phi/(3 - sin phi)                               M_psi = 6 sin psi/(3 - sin psi)
///   extension      M = 6 sin phi/(3 + sin phi)                               M_psi = 6 sin psi/(3 + sin psi)
///   plane strain   M = 3 sin phi sqrt(3 + sin^2 psi)/(3 + sin phi sin psi)   M_psi = 3 sin psi/sqrt(3 + sin^2 psi)
///
/// Deviation: in plane strain the book has M = 3 sin phi/sqrt(3 + sin^2 phi), Drucker and Prager's own match, which is
/// the above for psi = phi. For psi < phi that is weaker than Mohr-Coulomb, by 4 % at phi = 30 deg and psi = 0. The
/// above is exact: without plastic strain across the plane s_zz = -2/9 M_psi q, and Mohr's circle gives M.
///
/// Return, apex and openings are those of cohesive_friction.hpp.

#include <cmath>

#include "talus/law/cohesive_friction.hpp"

namespace talus {

/// The mode of failure in which the cone is as strong as Mohr and Coulomb's pyramid.
enum class ConeMatch { compression, plane_strain, extension };
inline constexpr Choice cone_match_choices[] = {
    {"compression", "triaxial compression: the cone around Mohr-Coulomb's pyramid, too strong elsewhere"},
    {"plane_strain", "failure in plane strain, at the dilatancy angle psi"},
    {"extension", "triaxial extension: the cone through the inner edges of the pyramid"},
};

/// Parameters of the cone; call `prepare` after setting them.
struct DruckerPrager : CohesiveFriction {
  ConeMatch matched_to = ConeMatch::compression;

  double M, M_psi;  ///< follow from the parameters: slopes of f and g

  TALUS_HD void prepare() {
    CohesiveFriction::prepare();
    M = strength_slope();
    M_psi = flow_slope();
  }

  /// M and M_psi, as at the top.
  TALUS_HD double strength_slope() const {
    const double s = std::sin(phi), t = std::sin(psi);
    switch (matched_to) {
      case ConeMatch::plane_strain: return 3 * s * std::sqrt(3 + t * t) / (3 + s * t);
      case ConeMatch::extension: return 6 * s / (3 + s);
      case ConeMatch::compression: break;
    }
    return 6 * s / (3 - s);
  }
  TALUS_HD double flow_slope() const {
    const double t = std::sin(psi);
    switch (matched_to) {
      case ConeMatch::plane_strain: return 3 * t / std::sqrt(3 + t * t);
      case ConeMatch::extension: return 6 * t / (3 + t);
      case ConeMatch::compression: break;
    }
    return 6 * t / (3 - t);
  }

  template <Number R>
  TALUS_HD Response<R> update(State<R>& state, const Motion<R>& motion, const Integration&) const {
    return flow(state, motion.strain, trial_deviator(state, motion.strain), M, M_psi);
  }

  /// Horizontal over vertical stress at rest: Jaky 1944, or the least the cone carries without cohesion,
  /// 3 (1 - k)/(1 + 2 k) = M.
  double earth_pressure_at_rest() const { return std::fmax(1 - std::sin(phi), (3 - M) / (3 + 2 * M)); }

  StateOrReason<State<double>> at_rest(const InitialState& initial) const { return state_within(M, initial); }

  static constexpr std::string_view name = "drucker_prager";
  static constexpr std::string_view meaning = "linear elasticity with the strength of Drucker and Prager's cone";
  static std::span<const ParameterOf<DruckerPrager>> parameters() {
    return cohesive_friction_parameters<DruckerPrager>();
  }
  static std::span<const OptionOf<DruckerPrager>> options();
  static std::span<const QuantityOf<DruckerPrager>> quantities() {
    return cohesive_friction_quantities<DruckerPrager>();
  }
};

inline std::span<const OptionOf<DruckerPrager>> DruckerPrager::options() {
  static const OptionOf<DruckerPrager> table[] = {
      {{"matched_to", "mode of failure in which the cone has the angles of Mohr-Coulomb", cone_match_choices},
       [](DruckerPrager& l, int choice) { l.matched_to = ConeMatch(choice); },
       [](const DruckerPrager& l) { return int(l.matched_to); }},
  };
  return table;
}

}  // namespace talus
