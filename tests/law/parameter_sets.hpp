#pragma once
/// The parameter sets of Tables 2-4 of Feng, Yin and Liang, as printed.

#include <numbers>
#include <string>

#include "talus/law/granular.hpp"
#include "talus/law/granular_rate.hpp"

namespace talus {

inline Simsand simsand(double E0, double nu, double n, double phi_c_degrees, double e_ref, double Lambda, double xi,
                       double A_d, double k_p, double n_p, double n_d) {
  Simsand s{E0, nu, n, phi_c_degrees * std::numbers::pi / 180, e_ref, Lambda, xi, A_d, k_p, n_p, n_d, LodeRule::sheng,
            {}};
  s.prepare();
  return s;
}

inline Simsand analysis_sand() { return simsand(150, .20, .6, 23, .907, .022, .71, .5, .001, 1, 1); }
inline Simsand wichtmann_sand() { return simsand(50, .15, .6, 31.3, 1.05, .0579, .4, 2, .01, 2.4, 2.9); }
inline Simsand polystyrene_sand() { return simsand(190, .235, .6, 23, .910, .122, .71, .5, .001, 1, 1); }
inline Simsand glass_sand() { return simsand(200, .235, .6, 25, .917, .122, .71, .5, .001, 1, 1); }
inline Simsand dem_sand() { return simsand(200, .235, .6, 21.11, .750, .122, .71, .5, .001, 1, 1); }
inline Simsand case_1_sand() { return simsand(150, .2, .5, 18.9, .877, .0596, .365, .7, .0044, 2.4, 2.9); }
inline Simsand case_2_sand() { return simsand(100, .2, .5, 16.7, .977, .0596, .365, .7, .0044, 2.4, 2.9); }

inline MuI table_3() { return {.28, 1090, 1e-3, .4245, .5718, .62, .29}; }
inline MuI polystyrene_grains() { return {.28, 1050, 1e-3, .4245, .5774, .62, .29}; }
inline MuI glass_grains() { return {.28, 2970, 1.8e-3, .4660, .5774, .62, .22}; }
inline MuI case_1_grains() { return {.28, 2500, 1e-3, .38, .66, .70, .29}; }

inline Granular case_1() { return {case_1_sand(), case_1_grains()}; }
inline GranularRate case_1_for_predictions() {
  GranularRate law{};
  law.frictional = case_1_sand();
  law.collisional = case_1_grains();
  law.zeta = 0.8;
  law.reach = 0.15;
  law.Phi_w = 0.02;
  law.E_g = 1e9;
  law.prepare();
  return law;
}

/// The frictional sets, with names for messages.
struct NamedSand {
  std::string name;
  Simsand law;
};
inline std::vector<NamedSand> all_sands() {
  return {{"analysis", analysis_sand()},
          {"Wichtmann", wichtmann_sand()},
          {"polystyrene", polystyrene_sand()},
          {"glass", glass_sand()},
          {"DEM", dem_sand()},
          {"case 1", case_1_sand()},
          {"case 2", case_2_sand()}};
}

/// A state under an isotropic pressure [Pa].
template <class Law>
typename Law::template State<double> isotropic_state(const Law& law, double p, double e) {
  InitialState initial;
  initial.stress = SymTensor<double>::isotropic(-p);
  initial.void_ratio = e;
  return std::get<typename Law::template State<double>>(law.at_rest(initial));
}

/// One step with the given strain increment (tension-positive) and nothing else.
inline Motion<double> strain_by(const SymTensor<double>& increment) {
  return {increment, SymTensor<double>::zero(), 1};
}

inline constexpr Integration implicit{Integrator::return_mapping, 1e-6};
inline constexpr Integration explicit_tight{Integrator::modified_euler, 1e-8};

}  // namespace talus
