#pragma once
/// Measured tests that are computed: their parameters are known.

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <random>

#include "talus/backend/backend.hpp"
#include "talus/calibration/calibrate.hpp"

namespace talus::synthetic {

using Values = std::vector<std::pair<std::string, double>>;

template <class Law>
AnyLaw law_with(const Values& values) {
  AnyLaw law = Law{};
  set_parameters(law, values);
  return law;
}

inline AnyLaw sand() {
  return law_with<Simsand>({{"E0", 150},
                            {"nu", 0.2},
                            {"n", 0.5},
                            {"phi_c", 0.56},
                            {"e_ref", 0.95},
                            {"Lambda", 0.04},
                            {"xi", 0.5},
                            {"A_d", 0.9},
                            {"k_p", 0.005},
                            {"n_p", 2},
                            {"n_d", 2}});
}

/// A path with quantities that have no values yet.
inline MeasuredTest path(std::string name, TestKind kind, TestDrainage drainage, double pressure, double void_ratio,
                         double end, int rows, const std::vector<std::pair<std::string, std::string>>& quantities) {
  MeasuredTest test;
  test.name = test.group = std::move(name);
  test.kind = kind;
  test.drainage = drainage;
  test.axial_stress = test.lateral_stress = pressure;
  test.void_ratio = void_ratio;
  for (int i = 0; i <= rows; ++i) {
    const double share = double(i) / rows;
    test.leading.push_back(test.is_led_by_stress() ? pressure * std::pow(end / pressure, share) : end * share);
  }
  for (const auto& [key, unit] : quantities)
    test.quantities.push_back({key, unit, std::vector<double>(test.leading.size(), 0), 1, 1, false});
  return test;
}
inline MeasuredTest drained(const std::string& name, double pressure, double void_ratio, double end = 0.2) {
  return path(name, TestKind::triaxial, TestDrainage::drained, pressure, void_ratio, end, 60,
              {{"q", "Pa"}, {"volumetric_strain", "1"}});
}

/// Gives a test the values that a law predicts, with noise of a share of the scale.
inline void measure(MeasuredTest& test, const AnyLaw& law, double noise = 0, unsigned seed = 1) {
  const Prediction p = predict(test, law, 1e-6);
  ASSERT_TRUE(p.failure.empty()) << p.failure;
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  for (std::size_t k = 0; k < test.quantities.size(); ++k) {
    MeasuredQuantity& q = test.quantities[k];
    q.values = p.values[k];
    if (!q.logarithmic) q.scale = scale_of(q.name, q.values);
    for (double& v : q.values) v += noise * q.scale * normal(random);
    q.values.front() = p.values[k].front();  // strains are measured from it
  }
}

/// A parameter that starts off its true value.
inline FreeParameter parameter(const std::string& key, double min, double max, double start) {
  return {key, "1", key, min, max, start, default_stage(key), min > 0 && max >= 5 * min};
}

inline Calibration calibration(const AnyLaw& start, std::vector<FreeParameter> free, std::vector<MeasuredTest> tests) {
  Calibration c;
  c.title = "synthetic";
  c.law = start;
  for (const FreeParameter& p : free) set_parameters(c.law, {{p.key, p.start}});
  c.free = std::move(free);
  c.tests = std::move(tests);
  c.settings.leave_one_out = c.settings.suggest_tests = false;
  c.settings.tolerance = 1e-6;
  return c;
}

inline CalibrationResult result_of(const Calibration& c, int threads = 1) {
  CalibrationState state;
  const auto loop = make_threads(threads);
  return *calibrate(c, *loop, state, {});
}

inline double value_of(const CalibrationResult& result, const std::string& key) {
  for (const NamedValue& v : parameters_of(result.law))
    if (v.parameter.key == key) return v.value;
  return NAN;
}

}  // namespace talus::synthetic
