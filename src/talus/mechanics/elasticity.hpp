#pragma once
/// Isotropic linear elasticity.

#include "talus/base/parameter.hpp"
#include "talus/mechanics/invariants.hpp"

namespace talus {

/// The two elastic constants of the user, and derived moduli.
struct Elasticity {
  double E;   ///< Young's modulus [Pa]
  double nu;  ///< Poisson's ratio

  void scale_stiffness(double factor) { E *= factor; }
  TALUS_HD double bulk_modulus() const { return E / (3 * (1 - 2 * nu)); }
  TALUS_HD double shear_modulus() const { return E / (2 * (1 + nu)); }
  /// K + 4/3 G [Pa], the modulus of compression without lateral strain.
  TALUS_HD double wave_modulus() const { return bulk_modulus() + 4.0 / 3.0 * shear_modulus(); }

  /// Stress increment due to a strain: K tr(eps) I + 2 G e.
  template <class R>
  TALUS_HD SymTensor<R> stress_increment(const SymTensor<R>& strain) const {
    return add_isotropic(R(2 * shear_modulus()) * deviator(strain), R(bulk_modulus()) * trace(strain));
  }
  /// p^2/(2 K) + q^2/(6 G) [J/m3]
  template <class R>
  TALUS_HD R energy_density(const SymTensor<R>& stress) const {
    const R p = pressure(stress);
    const SymTensor<R> s = deviator(stress);
    return R(0.5 / bulk_modulus()) * p * p + R(0.25 / shear_modulus()) * double_dot(s, s);
  }
};

/// E and nu in the table of parameters of a law with `Elasticity`.
template <class Law>
ParameterOf<Law> youngs_modulus() {
  return {{"E", "Pa", Range::positive(), "Young's modulus"}, [](Law& l) -> double& { return l.E; }};
}
template <class Law>
ParameterOf<Law> poissons_ratio() {
  return {{"nu", "1", {-1, 0.5, true, true}, "Poisson's ratio"}, [](Law& l) -> double& { return l.nu; }};
}

}  // namespace talus
