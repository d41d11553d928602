/// User_Mod of PLAXIS, a user-defined soil model.
///
/// Stresses and strains are tension-positive, in the order xx, yy, zz, xy, yz, zx, with engineering shear strains. PLAXIS has kPa:
/// stress_unit is 1000. `dTime` counts in seconds. Props holds 50 numbers. Constants and state variables:
/// law/constants.hpp, host.hpp.

#include <algorithm>
#include <cmath>

#include "host.hpp"

namespace talus {

namespace {

constexpr int n_props_of_plaxis = 50;
/// Water is so many times stiffer than the skeleton in undrained steps.
constexpr double water_over_skeleton = 100;

enum class Task { start = 1, stress, tangent, count_state_variables, attributes, elastic_stiffness };

SymTensor<double> tensor_of_plaxis(const double* a, double shear) {
  return {a[0], a[1], a[2], shear * a[3], shear * a[4], shear * a[5]};
}

/// Whether the stress of a law depends on the strain rate.
bool depends_on_rate(const AnyLaw& law) {
  return std::holds_alternative<Granular>(law) || std::holds_alternative<GranularWithHistory>(law) ||
         std::holds_alternative<GranularRate>(law) || std::holds_alternative<MuI>(law) ||
         std::holds_alternative<LocalMuI>(law) || std::holds_alternative<NewtonianFluid>(law);
}

}  // namespace

}  // namespace talus

extern "C" {

void user_mod_(const int* task, const int* /*iMod*/, const int* is_undrained, const int* /*iStep*/, const int* /*iter*/,
               const int* element, const int* point_number, const double* /*X*/, const double* /*Y*/,
               const double* /*Z*/, const double* /*Time0*/, const double* dtime, const double* props,
               const double* stress0, const double* pore_pressure0, double* state0, const double* strain, double* D,
               double* bulk_water, double* stress, double* pore_pressure, double* state, int* /*ipl*/, int* n_state,
               int* non_symmetric, int* stress_dependent, int* time_dependent, int* tangent, const int* /*iPrjDir*/,
               const int* /*iPrjLen*/, int* abort) {
  using namespace talus;
  const auto fail = [&](const std::string& text) {
    report_failure("User_Mod",
                   "element " + std::to_string(*element) + ", point " + std::to_string(*point_number) + ":\n" + text);
    *abort = 1;
  };
  *abort = 0;
  const Task what = Task(*task);
  double work[largest_state + n_leading_state_variables] = {};
  HostPoint point({props, n_props_of_plaxis}, "Props", what == Task::start ? state0 : work, int(std::size(work)));
  if (!point.fault().empty()) return fail(point.fault());
  const int n = point.n_state_variables();
  if (what == Task::count_state_variables) {
    *n_state = n;
    return;
  }
  if (what == Task::attributes) {
    *non_symmetric = 1;
    *stress_dependent = 1;
    *time_dependent = depends_on_rate(point.material().law);
    *tangent = 1;
    return;
  }
  if (what == Task::start) {
    point.start(tensor_of_plaxis(stress0, 1));
    if (!point.fault().empty()) fail(point.fault());
    return;
  }
  std::copy(state0, state0 + n, work);
  point.start(tensor_of_plaxis(stress0, 1));  // if task 1 was not called
  if (!point.fault().empty()) return fail(point.fault());
  double elastic[36], matrix[36];
  point.elastic_stiffness(elastic);
  if (*is_undrained == 1)
    *bulk_water = water_over_skeleton * (elastic[0] + 2 * elastic[1]) / 3;
  else
    *bulk_water = 0;
  const double* shown = elastic;
  if (what == Task::stress || what == Task::tangent) {
    const Response<double> r =
        point.step(tensor_of_plaxis(strain, 0.5), *dtime, what == Task::tangent ? matrix : nullptr);
    shown = matrix;
    if (what == Task::stress) {
      const SymTensor<double> now = point.stress();
      bool is_finite = true;
      for (int i = 0; i < 6; ++i) {
        stress[i] = now[i];
        is_finite = is_finite && std::isfinite(now[i]);
      }
      std::copy(work, work + n, state);
      *pore_pressure = *pore_pressure0 + *bulk_water * (strain[0] + strain[1] + strain[2]);
      if (r.outcome == double(Outcome::unconverged) || !is_finite) *abort = 1;
      return;
    }
  }
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j) D[i + 6 * j] = shown[6 * i + j];
}

}  // extern "C"
