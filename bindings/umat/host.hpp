#pragma once
/// What the user materials of all finite element programs have in common: a list of constants (law/constants.hpp), state
/// variables, and a step.
///
/// State variables:
///   1    void_ratio   at the first call: the void ratio to start from, 0: that of the constants; then the present one, or the
///                     relative change of volume of laws without void ratio
///   2    status       0: not started; then 1 + outcome (0 elastic, 1 plastic, 2 zero pressure, 3 separated, 4 unconverged)
///   3 .. the state of the law in SI units, fields and order as in law/state_fields.hpp, tension-positive
///
/// Tensors are tension-positive, xx, yy, zz, xy, yz, zx; shear strains are tensor components.

#include <span>
#include <string>

#include "talus/law/constants.hpp"
#include "talus/law/point.hpp"

namespace talus {

inline constexpr int n_leading_state_variables = 2;

/// A point of a finite element program in one step.
class HostPoint {
 public:
  /// The material and the state variables, which the point changes.
  HostPoint(std::span<const double> constants, std::string_view array_of_constants, double* state_variables,
            int n_state_variables);

  /// Everything that is wrong; empty if nothing is.
  const std::string& fault() const { return fault_; }
  const MaterialConstants& material() const { return material_; }
  int n_state_variables() const { return n_leading_state_variables + state_size_of(material_.law); }

  /// Before the first step: the state under `stress`, in units of the host. Later calls change nothing.
  void start(const SymTensor<double>& stress);
  /// Rotates the state; a tensor of zeros stands for no rotation.
  void turn(const Tensor<double>& Q);
  /// A step. Without `dt` it is infinitely slow: the rate-independent part alone. `tangent` in units of the host, by
  /// engineering shear strains, may be null. Works of the response are in units of the host.
  Response<double> step(const SymTensor<double>& strain, double dt, double* tangent);

  SymTensor<double> stress() const;  ///< [units of the host]
  double elastic_energy() const;     ///< [units of the host]
  /// Isotropic elastic stiffness at the present state, row by row [units of the host].
  void elastic_stiffness(double* matrix) const;

 private:
  double* state() const { return variables_ + n_leading_state_variables; }
  void note(double outcome);

  MaterialConstants material_;
  double* variables_;
  std::string fault_;
};

/// Prints a message where the log of the host is likely to have it.
void report_failure(const char* interface, const std::string& text);

}  // namespace talus
