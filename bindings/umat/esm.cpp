/// ESM of Anura3D, an external soil model.
///
/// Stresses and strains are tension-positive, in the order xx, yy, zz, xy, yz, zx (NTENS = 6) or xx, yy, zz, xy (4), with
/// engineering shear strains. Anura3D has kPa: stress_unit is 1000. Time passes in its interface as ADDITIONALVAR(9), the
/// length of the step [s]; 0 leaves the rate-independent part alone. Constants and state variables: law/constants.hpp, host.hpp.

#include <algorithm>
#include <cmath>
#include <limits>

#include "host.hpp"

extern "C" {

void esm_(const int* npt, const int* noel, const int* /*idset*/, double* stress, double* unloading_stiffness,
          double* plastic_multiplier, const double* dstran, const int* nstatev, double* statev, const int* naddvar,
          const double* additionalvar, const char* /*cmname*/, const int* nprops, const double* props,
          const int* /*numberofphases*/, const int* ntens, std::size_t /*length_of_cmname*/) {
  using namespace talus;
  constexpr int place_of_dt = 8;
  const int n = *ntens;
  const auto fail = [&](const std::string& text) {
    report_failure("ESM", "element " + std::to_string(*noel) + ", point " + std::to_string(*npt) + ":\n" + text);
    for (int i = 0; i < n; ++i) stress[i] = std::numeric_limits<double>::quiet_NaN();
  };
  if (n != 4 && n != 6) return fail("NTENS must be 6 or 4");
  HostPoint point({props, std::size_t(std::max(*nprops, 0))}, "PROPS", statev, *nstatev);
  SymTensor<double> stress_at_start = SymTensor<double>::zero(), strain = SymTensor<double>::zero();
  for (int i = 0; i < n; ++i) {
    stress_at_start[i] = stress[i];
    strain[i] = i < 3 ? dstran[i] : 0.5 * dstran[i];
  }
  if (point.fault().empty()) point.start(stress_at_start);
  if (!point.fault().empty()) return fail(point.fault());
  const Response<double> r = point.step(strain, *naddvar > place_of_dt ? additionalvar[place_of_dt] : 0, nullptr);
  const SymTensor<double> now = point.stress();
  for (int i = 0; i < n; ++i) stress[i] = now[i];
  *unloading_stiffness = r.stiffness;  // for the speed of waves
  *plastic_multiplier = r.outcome == double(Outcome::plastic);
}

}  // extern "C"
