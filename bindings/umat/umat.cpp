/// UMAT of Abaqus/Standard.
///
/// Stresses and strains are tension-positive, in the order 11, 22, 33, 12, 13, 23, with engineering shear strains. NTENS is 6
/// (three-dimensional) or 4 (plane strain, axisymmetric). Constants and state variables: law/constants.hpp, host.hpp.

#include <cmath>
#include <limits>

#include "host.hpp"

namespace talus {

namespace {

/// Where components 11, 22, 33, 12, 13, 23 stand in xx, yy, zz, xy, yz, zx.
constexpr int component_of_umat[6] = {0, 1, 2, 3, 5, 4};

}  // namespace

}  // namespace talus

extern "C" {

/// What Abaqus offers to end an analysis; absent in other hosts.
[[gnu::weak]] void xit_();

void umat_(double* stress, double* statev, double* ddsdde, double* sse, double* spd, double* scd, double* rpl,
           double* ddsddt, double* drplde, double* drpldt, const double* /*stran*/, const double* dstran,
           const double* /*time*/, const double* dtime, const double* /*temp*/, const double* /*dtemp*/,
           const double* /*predef*/, const double* /*dpred*/, const char* /*cmname*/, const int* ndi, const int* nshr,
           const int* ntens, const int* nstatv, const double* props, const int* nprops, const double* /*coords*/,
           const double* drot, double* pnewdt, const double* /*celent*/, const double* /*dfgrd0*/,
           const double* /*dfgrd1*/, const int* noel, const int* npt, const int* /*layer*/, const int* /*kspt*/,
           const int* /*jstep*/, const int* /*kinc*/, std::size_t /*length_of_cmname*/) {
  using namespace talus;
  const int n = *ntens;
  const auto fail = [&](const std::string& text) {
    report_failure("UMAT", "element " + std::to_string(*noel) + ", point " + std::to_string(*npt) + ":\n" + text);
    for (int i = 0; i < n; ++i) stress[i] = std::numeric_limits<double>::quiet_NaN();
    *pnewdt = std::min(*pnewdt, 0.25);
    if (xit_) xit_();
  };
  if (*ndi != 3 || (*nshr != 1 && *nshr != 3) || n != *ndi + *nshr)
    return fail("NTENS must be 6 or 4, with NDI = 3; plane stress and shells are not supported");
  HostPoint point({props, std::size_t(std::max(*nprops, 0))}, "PROPS", statev, *nstatv);
  SymTensor<double> stress_at_start = SymTensor<double>::zero(), strain = SymTensor<double>::zero();
  for (int i = 0; i < n; ++i) {
    stress_at_start[component_of_umat[i]] = stress[i];
    strain[component_of_umat[i]] = i < 3 ? dstran[i] : 0.5 * dstran[i];
  }
  if (point.fault().empty()) {
    const bool first = statev[1] == 0;
    point.start(stress_at_start);
    // Abaqus has turned STRESS already, from which a point starts; DROT is column by column.
    if (!first && point.fault().empty())
      point.turn({{{drot[0], drot[3], drot[6]}, {drot[1], drot[4], drot[7]}, {drot[2], drot[5], drot[8]}}});
  }
  if (!point.fault().empty()) return fail(point.fault());
  double tangent[36];
  const Response<double> r = point.step(strain, *dtime, tangent);
  const SymTensor<double> now = point.stress();
  bool is_finite = true;
  for (int i = 0; i < n; ++i) {
    const int row = component_of_umat[i];
    stress[i] = now[row];
    is_finite = is_finite && std::isfinite(stress[i]);
    for (int j = 0; j < n; ++j) ddsdde[i + n * j] = tangent[6 * row + component_of_umat[j]];
    ddsddt[i] = drplde[i] = 0;
  }
  *rpl = *drpldt = 0;
  *sse = point.elastic_energy();
  *spd += r.plastic_work;
  *scd += r.collisional_work;
  if (r.outcome == double(Outcome::unconverged) || !is_finite) *pnewdt = std::min(*pnewdt, 0.25);
}

}  // extern "C"
