/// Points whose state is an array of numbers: tangent, arrays, constants of user materials.

#include "talus/law/point.hpp"

#include <gtest/gtest.h>

#include "law/parameter_sets.hpp"
#include "talus/law/constants.hpp"

namespace talus {
namespace point_test {

const Integration accurate{Integrator::modified_euler, 1e-8};

struct PointInPhase {
  std::string name;
  AnyLaw law;
  InitialState initial;
  Integration how;
  std::vector<Motion<double>> before;  ///< steps that lead to the point
  Motion<double> step;                 ///< the step whose tangent is checked
  double outcome;                      ///< of that step
};

Motion<double> moved(const SymTensor<double>& strain, double dt) { return {strain, (1 / dt) * strain, dt}; }
InitialState pressed(double p, double e = 0) {
  InitialState initial;
  initial.stress = SymTensor<double>::isotropic(-p);
  initial.void_ratio = e;
  return initial;
}

const SymTensor<double> small{-2e-6, 1e-6, -1e-6, 1.5e-6, -1e-6, 0.5e-6},
    large = 1e3 * small, opening{1e-2, 1.1e-2, 0.9e-2, 1e-3, 0, -1e-3}, pressing{-1e-4, -2e-4, -1e-4, 1e-5, 0, 0};

LinearElastic elastic() {
  LinearElastic l{};
  l.E = 1e7;
  l.nu = 0.3;
  return l;
}
template <class Law>
Law cohesive() {
  Law l{};
  l.E = 2e7;
  l.nu = 0.3;
  l.c = 5e3;
  l.phi = 0.5;
  l.psi = 0.1;
  l.prepare();
  return l;
}
LocalMuI rheology() {
  LocalMuI l{};
  l.E = 1e6;
  l.nu = 0.3;
  l.rho_s = 2500;
  l.d = 1e-3;
  l.I_0 = 0.3;
  l.mu_s = 0.4;
  l.mu_d = 0.7;
  l.prepare();
  return l;
}
AnyLaw with_history(CollisionalForm form) {
  Granular l = case_1();
  l.collisional.form = form;
  return settled(l);
}

/// Every law in every phase that it has.
std::vector<PointInPhase> all_setups() {
  const Integration implicit_{Integrator::return_mapping, 1e-6};
  const double elastic_ = double(Outcome::elastic), plastic = double(Outcome::plastic),
               separated = double(Outcome::separated);
  std::vector<PointInPhase> all;
  const auto add = [&](std::string name, AnyLaw law, InitialState initial, const Integration& how,
                       std::vector<Motion<double>> before, Motion<double> step, double outcome) {
    all.push_back({std::move(name), std::move(law), initial, how, std::move(before), step, outcome});
  };
  add("linear_elastic", elastic(), pressed(1e5), accurate, {}, moved(large, 1), elastic_);
  for (const auto& [name, law] : std::initializer_list<std::pair<const char*, AnyLaw>>{
           {"mohr_coulomb", cohesive<MohrCoulomb>()}, {"drucker_prager", cohesive<DruckerPrager>()}}) {
    add(std::string(name) + " elastic", law, pressed(1e5), accurate, {}, moved(small, 1), elastic_);
    add(std::string(name) + " plastic", law, pressed(1e5), accurate, {moved(10 * large, 1)}, moved(large, 1), plastic);
    add(std::string(name) + " separated", law, pressed(1e5), accurate, {moved(10 * opening, 1)}, moved(small, 1),
        separated);
  }
  add("local_mu_i elastic", rheology(), pressed(1e3), accurate, {}, moved(small, 1), elastic_);
  add("local_mu_i flowing", rheology(), pressed(1e3), accurate, {moved(10 * large, 1e-2)}, moved(large, 1e-3), plastic);
  add("local_mu_i separated", rheology(), pressed(1e3), accurate, {moved(opening, 1)}, moved(small, 1), separated);
  NewtonianFluid water{1e6, 1e-1};
  add("newtonian_fluid pressed", water, pressed(1e3), accurate, {}, moved(pressing, 1e-4), elastic_);
  add("newtonian_fluid open", water, pressed(1e3), accurate, {moved(opening, 1)}, moved(small, 1e-4), separated);
  InitialState colliding = pressed(0, 0.8);
  colliding.background_pressure = 500;
  add("mu_i", case_1_grains(), colliding, accurate, {}, moved(large, 1e-4), plastic);
  for (const auto& [scheme, how] : std::initializer_list<std::pair<const char*, Integration>>{
           {", implicit", implicit_}, {", explicit", accurate}}) {
    for (const auto& [name, law] : std::initializer_list<std::pair<const char*, AnyLaw>>{
             {"simsand", case_1_sand()},
             {"granular", case_1()},
             {"granular_rate", case_1_for_predictions()},
             {"granular incremental", with_history(CollisionalForm::incremental)},
             {"granular rate form", with_history(CollisionalForm::rate)}}) {
      const auto named = [of = std::string(name), with = scheme](const char* phase) { return of + phase + with; };
      const InitialState dense = pressed(1e5, 0.7);
      // Back a little after loading: inside the yield surface.
      add(named(" elastic"), law, dense, how, {moved(large, 10), moved(-2 * small, 1)}, moved(-small, 1), elastic_);
      add(named(" plastic"), law, dense, how, {moved(5 * large, 10)}, moved(large, 1), plastic);
      add(named(" flowing"), law, pressed(1e3, 0.85), how, {moved(20 * large, 1e-3)}, moved(large, 1e-4), plastic);
      add(named(" separated"), law, dense, how, {moved(opening, 1)}, moved(large, 1e-3), separated);
    }
  }
  return all;
}

std::vector<double> state_before(const PointInPhase& s) {
  auto state = std::get<std::vector<double>>(state_at_rest(s.law, s.initial));
  for (const Motion<double>& m : s.before) update_point(s.law, state.data(), m, s.how);
  return state;
}

SymTensor<double> stress_after(const PointInPhase& s, const std::vector<double>& from, Motion<double> motion) {
  std::vector<double> state = from;
  update_point(s.law, state.data(), motion, s.how);
  return stress_of_point(s.law, state.data());
}

TEST(Tangent, PredictsTheStressOfANeighbouringStepForEveryLawInEveryPhase) {
  // Independent of the differences inside: one point at a time, an oblique direction that no column has, eighth-order
  // central differences (Fornberg 1988, Table 1) at another length.
  const SymTensor<double> direction{0.6, -0.4, 0.3, 0.25, -0.35, 0.2};
  const double weights[] = {4.0 / 5, -1.0 / 5, 4.0 / 105, -1.0 / 280};
  for (const PointInPhase& s : all_setups()) {
    const std::vector<double> before = state_before(s);
    std::vector<double> state = before;
    double tangent[36];
    const Response<double> r = update_point_with_tangent(s.law, state.data(), s.step, s.how, tangent);
    EXPECT_EQ(r.outcome, s.outcome) << s.name;
    std::vector<double> alone = before;
    update_point(s.law, alone.data(), s.step, s.how);
    EXPECT_EQ(state, alone) << s.name << ": the tangent must not change the step";

    const SymTensor<double> stress = stress_of_point(s.law, state.data());
    const double strain_of_stress = r.stiffness > 0 ? std::sqrt(double_dot(stress, stress)) / r.stiffness : 0;
    const double h = 3e-4 * (strain_of_stress > 0 ? strain_of_stress : 1e-3);
    SymTensor<double> expected = SymTensor<double>::zero();
    for (int k = 1; k <= 4; ++k)
      for (int sign : {-1, 1}) {
        const SymTensor<double> change = (sign * k * h) * direction;
        const Motion<double> there{s.step.strain + change, s.step.strain_rate + (1 / s.step.dt) * change, s.step.dt};
        expected = expected + (sign * weights[k - 1] / h) * stress_after(s, before, there);
      }
    double largest = 0, error = 0;
    for (int i = 0; i < 6; ++i) {
      double predicted = 0;
      for (int j = 0; j < 6; ++j) predicted += tangent[6 * i + j] * direction[j] * (j < 3 ? 1 : 2);
      largest = std::max(largest, std::abs(expected[i]));
      error = std::max(error, std::abs(predicted - expected[i]));
    }
    EXPECT_LE(error, 1e-7 * largest) << s.name << ": relative error " << error / largest;
  }
}

TEST(Tangent, OfLinearElasticityIsHookes) {
  std::vector<double> state = std::get<std::vector<double>>(state_at_rest(elastic(), pressed(1e5)));
  double tangent[36];
  update_point_with_tangent(elastic(), state.data(), moved(large, 1), accurate, tangent);
  // E = 10 MPa, nu = 0.3: lambda + 2 G = 13.4615 MPa, lambda = 5.76923 MPa, G = 3.84615 MPa
  for (int i = 0; i < 6; ++i)
    for (int j = 0; j < 6; ++j)
      EXPECT_NEAR(tangent[6 * i + j],
                  i < 3 && j < 3 ? (i == j ? 13.4615385e6 : 5.7692308e6) : (i == j ? 3.8461538e6 : 0), 20);
}

TEST(Tangent, OfAFluidHasItsViscosityOverTheStep) {
  const AnyLaw water = NewtonianFluid{1e6, 0.5};
  std::vector<double> state = std::get<std::vector<double>>(state_at_rest(water, pressed(1e3)));
  double tangent[36];
  update_point_with_tangent(water, state.data(), moved(pressing, 1e-4), accurate, tangent);
  EXPECT_NEAR(tangent[6 * 3 + 3], 0.5 / 1e-4, 0.1);         // eta/dt by the engineering shear strain
  EXPECT_NEAR(tangent[0], 1e6 + 4.0 / 3 * 0.5 / 1e-4, 20);  // K + 4/3 eta/dt
}

TEST(Points, AreUpdatedInArraysWithTheBitsOfOneByOne) {
  for (const PointInPhase& s : all_setups()) {
    const std::vector<double> before = state_before(s);
    const int n = 11, size = state_size_of(s.law);
    std::vector<double> many, strains, rates;
    for (int i = 0; i < n; ++i) {
      many.insert(many.end(), before.begin(), before.end());
      for (int k = 0; k < 6; ++k) {
        strains.push_back((1 + 0.1 * i) * s.step.strain[k]);
        rates.push_back((1 + 0.1 * i) * s.step.strain_rate[k]);
      }
    }
    std::vector<Response<double>> responses(n);
    update_points(s.law, n, many.data(), strains.data(), rates.data(), s.step.dt, s.how, responses.data());
    for (int i = 0; i < n; ++i) {
      std::vector<double> one = before;
      Motion<double> m{{}, {}, s.step.dt};
      for (int k = 0; k < 6; ++k) {
        m.strain[k] = strains[std::size_t(6 * i + k)];
        m.strain_rate[k] = rates[std::size_t(6 * i + k)];
      }
      const Response<double> r = update_point(s.law, one.data(), m, s.how);
      EXPECT_TRUE(std::equal(one.begin(), one.end(), many.begin() + i * size)) << s.name << ", point " << i;
      EXPECT_EQ(r.work, responses[std::size_t(i)].work) << s.name;
    }
  }
}

TEST(Points, WithoutTimeFeelTheRateIndependentPartAlone) {
  // In `long_time` at no rate friction of flow is that at rest: tau = mu_s p, however far the strain goes.
  std::vector<double> state = std::get<std::vector<double>>(state_at_rest(rheology(), pressed(1e3)));
  const Motion<double> slow{{0, 0, 0, 0.1, 0, 0}, SymTensor<double>::zero(), long_time};
  update_point(rheology(), state.data(), slow, accurate);
  EXPECT_NEAR(stress_of_point(rheology(), state.data()).xy, 0.4 * 1e3, 1e-6);
}

TEST(Constants, OfAUserMaterialMakeTheLawThatTheyWereMadeFrom) {
  for (const PointInPhase& s : all_setups()) {
    MaterialConstants m;
    m.law = s.law;
    m.stress_unit = 1000;
    m.void_ratio = 0.7;
    std::vector<double> values;
    for (const NamedConstant& c : constants_of(m)) values.push_back(c.value);
    const auto read = material_from_constants(values);
    ASSERT_TRUE(std::holds_alternative<MaterialConstants>(read)) << std::get<std::string>(read);
    const auto& back = std::get<MaterialConstants>(read);
    EXPECT_EQ(back.stress_unit, 1000);
    EXPECT_EQ(back.law.index(), s.law.index()) << s.name;
    const std::vector<double> before = state_before(s);
    std::vector<double> a = before, b = before;
    update_point(s.law, a.data(), s.step, s.how);
    update_point(back.law, b.data(), s.step, s.how);
    EXPECT_EQ(a, b) << s.name;
  }
}

TEST(Constants, EveryNamedLawHasANumberOfItsOwn) {
  std::map<int, int> seen;
  Laws::for_each([&]<class Law>() {
    if (is_named<Law>) ++seen[number_of_law(Law::name)];
  });
  EXPECT_FALSE(seen.contains(0));
  for (const auto& [number, times] : seen) EXPECT_EQ(times, 1) << number;
}

TEST(Constants, ReportAllThatIsWrongWithTheirPlace) {
  // linear_elastic: 8, unit 1, modified_euler, tolerance, void ratio, pressure; E, nu; stress_measure
  const double wrong[] = {8, 1, 0.5, 0, 0, 0, -1e7, 0.7, 0};
  const auto read = material_from_constants(wrong);
  ASSERT_TRUE(std::holds_alternative<std::string>(read));
  const std::string text = std::get<std::string>(read);
  EXPECT_NE(text.find("PROPS(3) integrator = 0.5 is not a whole number"), text.npos) << text;
  EXPECT_NE(text.find("PROPS(7) E = -1e+07 is out of range; it must be greater than 0"), text.npos) << text;
  EXPECT_NE(text.find("PROPS(8) nu = 0.7 is out of range"), text.npos) << text;
  const double no_law[] = {77, 1, 0, 0, 0, 0};
  EXPECT_NE(std::get<std::string>(material_from_constants(no_law)).find("77 is no law; the laws are 1 granular"),
            text.npos);
}

}  // namespace point_test
}  // namespace talus
