/// The C interface of the laws: same bits as the element driver, same complaints as the reader.

#include <gtest/gtest.h>

#include <thread>

#include "law/parameter_sets.hpp"
#include "talus/case/loading.hpp"
#include "talus/element/driver.hpp"
#include "talus/law.h"

namespace talus {
namespace law_in_c_test {

struct Freed {
  void operator()(talus_law* law) const { talus_law_free(law); }
};
using Held = std::unique_ptr<talus_law, Freed>;

const std::vector<talus_setting> sand = {
    {"E0", "150", 0},      {"nu", "0.2", 0},       {"n", nullptr, 0.5}, {"phi_c", "18.9 deg", 0},
    {"e_ref", "0.877", 0}, {"Lambda", ".0596", 0}, {"xi", "0.365", 0},  {"A_d", nullptr, 0.7},
    {"k_p", "4.4e-3", 0},  {"n_p", "2.4", 0},      {"n_d", "2.9", 0},
};
std::vector<talus_setting> sand_and_grains() {
  std::vector<talus_setting> all = sand;
  for (const talus_setting& s : std::initializer_list<talus_setting>{{"I_0", "0.28", 0},
                                                                     {"rho_s", "2.5 g/cm3", 0},
                                                                     {"d", nullptr, 1e-3},
                                                                     {"mu_s", "0.38", 0},
                                                                     {"mu_d", "0.66", 0},
                                                                     {"Phi_c", "0.7", 0},
                                                                     {"dPhi", "0.29", 0}})
    all.push_back(s);
  return all;
}

Held made(const char* name, const std::vector<talus_setting>& settings) {
  talus_law* law = nullptr;
  char message[4000];
  EXPECT_EQ(talus_law_make(name, settings.data(), settings.size(), &law, message, sizeof message), TALUS_OK) << message;
  return Held(law);
}

std::string complaint(const char* name, const std::vector<talus_setting>& settings) {
  talus_law* law = nullptr;
  char message[4000];
  EXPECT_EQ(talus_law_make(name, settings.data(), settings.size(), &law, message, sizeof message), TALUS_INPUT_ERROR);
  EXPECT_EQ(law, nullptr);
  return message;
}

TEST(LawInC, HasTheBitsOfTheElementDriver) {
  // Simple shear forth and back at 0.1/s, then opening: contacts and collisions.
  ElementTest test;
  Granular law = case_1();
  test.law = law;
  test.initial.stress = SymTensor<double>::isotropic(-1e4);
  test.initial.void_ratio = 0.8;
  const double rates[][6] = {{0, 0, 0, 0.1, 0, 0}, {0, 0, 0, -0.1, 0, 0}, {-0.02, -0.01, -0.01, 0.05, 0, 0}};
  for (const auto& rate : rates) {
    Segment s;
    s.duration = 0.5;
    s.rows = 40;
    for (int i = 0; i < 6; ++i) s.controls[std::size_t(i)] = strain_control(i, rate[i]);
    test.segments.push_back(s);
  }
  const ElementResult expected = run_element_test(test);

  const Held c = made("granular", sand_and_grains());
  talus_initial initial;
  talus_initial_defaults(&initial);
  for (int i = 0; i < 3; ++i) initial.stress[i] = -1e4;
  initial.void_ratio = 0.8;
  std::vector<double> state(talus_law_state_size(c.get()));
  char message[1000];
  ASSERT_EQ(talus_law_initial_state(c.get(), &initial, state.data(), message, sizeof message), TALUS_OK) << message;
  double total[6] = {};
  std::size_t row = 1;
  for (const auto& rate : rates) {
    double at_start[6], before = 0;
    std::copy(total, total + 6, at_start);
    for (int k = 1; k <= 40; ++k, ++row) {
      const double t = k == 40 ? 0.5 : 0.5 * k / 40;
      double increment[6], strain_rate[6];
      for (int i = 0; i < 6; ++i) {
        const double change = at_start[i] + rate[i] * t - total[i];
        total[i] += change;
        increment[i] = 0 - change;
        strain_rate[i] = 0 - rate[i];
      }
      talus_response r;
      talus_law_update(c.get(), state.data(), increment, strain_rate, t - before, &r);
      before = t;
      const int first = expected.column("stress_xx");
      for (int i = 0; i < 6; ++i)
        ASSERT_EQ(0 - r.stress[i] + 0.0, expected.rows[row][std::size_t(first + i)])
            << "row " << row << ", component " << i;
      ASSERT_EQ(r.outcome, expected.rows[row].back());
    }
  }
}

TEST(LawInC, ReportsAllMistakesAtOnceWithSuggestions) {
  std::vector<talus_setting> wrong = sand;
  wrong[0] = {"E0", "-1", 0};
  wrong[3] = {"phi_c", "30", 0};
  wrong[4] = {"e_reff", "0.877", 0};
  wrong.push_back({"lode", "shang", 0});
  const std::string text = complaint("simsand", wrong);
  EXPECT_NE(text.find("E0 = -1 is out of range; it must be greater than 0"), text.npos) << text;
  EXPECT_NE(text.find("phi_c = \"30\""), text.npos) << text;
  EXPECT_NE(text.find("`e_ref` is missing"), text.npos) << text;
  EXPECT_NE(text.find("did you mean `e_ref`"), text.npos) << text;
  EXPECT_NE(text.find("did you mean `sheng`"), text.npos) << text;
  EXPECT_NE(complaint("simsnd", sand).find("did you mean `simsand`"), text.npos);
}

TEST(LawInC, RefusesNumbersOutOfRangeAndNotFinite) {
  for (double nu : {0.7, std::nan(""), double(INFINITY)})
    EXPECT_FALSE(complaint("linear_elastic", {{"E", nullptr, 1e7}, {"nu", nullptr, nu}}).empty());
  EXPECT_FALSE(complaint("linear_elastic", {{"E", nullptr, std::nan("")}, {"nu", nullptr, 0.3}}).empty());
  EXPECT_FALSE(complaint("linear_elastic", {{"E", "1 MPa", 0}, {"E", "2 MPa", 0}, {"nu", nullptr, 0.3}}).empty());
}

TEST(LawInC, NamesItsState) {
  const Held c = made("simsand", sand);
  EXPECT_STREQ(talus_law_name(c.get()), "simsand");
  ASSERT_EQ(talus_law_state_fields(c.get()), 4u);
  EXPECT_STREQ(talus_law_state_field(c.get(), 0)->name, "frictional_stress");
  EXPECT_STREQ(talus_law_state_field(c.get(), 0)->unit, "Pa");
  EXPECT_EQ(talus_law_state_field(c.get(), 0)->components, 6);
  EXPECT_STREQ(talus_law_state_field(c.get(), 2)->name, "kappa");
  EXPECT_EQ(talus_law_state_field(c.get(), 4), nullptr);
  EXPECT_EQ(talus_law_state_size(c.get()), 9u);
}

TEST(LawInC, RefusesImpossibleStatesWithAReason) {
  const Held c = made("simsand", sand);
  std::vector<double> state(talus_law_state_size(c.get()));
  talus_initial initial;
  talus_initial_defaults(&initial);
  char message[1000], cut[8];
  EXPECT_EQ(talus_law_initial_state(c.get(), &initial, state.data(), message, sizeof message), TALUS_INPUT_ERROR);
  EXPECT_NE(std::string(message).find("void_ratio = 0 is out of range"), std::string::npos) << message;
  initial.void_ratio = 0.7;
  initial.stress[0] = 1e5;
  EXPECT_EQ(talus_law_initial_state(c.get(), &initial, state.data(), cut, sizeof cut), TALUS_INPUT_ERROR);
  EXPECT_EQ(std::string(cut), "the ini");
}

TEST(LawInC, IsUsedByThreadsAtOnce) {
  const Held c = made("granular", sand_and_grains());
  talus_initial initial;
  talus_initial_defaults(&initial);
  for (int i = 0; i < 3; ++i) initial.stress[i] = -1e4;
  initial.void_ratio = 0.8;
  std::vector<std::vector<double>> states(4, std::vector<double>(talus_law_state_size(c.get())));
  std::vector<std::thread> threads;
  for (auto& state : states)
    threads.emplace_back([&] {
      ASSERT_EQ(talus_law_initial_state(c.get(), &initial, state.data(), nullptr, 0), TALUS_OK);
      const double strain[6] = {0, 0, 0, 1e-4, 0, 0};
      double tangent[36];
      for (int k = 0; k < 10; ++k)
        talus_law_update_with_tangent(c.get(), state.data(), strain, nullptr, 1e-3, nullptr, tangent);
    });
  for (auto& t : threads) t.join();
  for (const auto& state : states) EXPECT_EQ(state, states[0]);
}

TEST(LawInC, TurnsItsStateWithTheMaterial) {
  const Held c = made("linear_elastic", {{"E", "1 MPa", 0}, {"nu", "0.3", 0}});
  talus_initial initial;
  talus_initial_defaults(&initial);
  initial.stress[0] = -100;
  std::vector<double> state(talus_law_state_size(c.get()));
  ASSERT_EQ(talus_law_initial_state(c.get(), &initial, state.data(), nullptr, 0), TALUS_OK);
  const double quarter_turn[9] = {0, -1, 0, 1, 0, 0, 0, 0, 1};
  talus_law_rotate(c.get(), state.data(), quarter_turn);
  double stress[6];
  talus_law_stress(c.get(), state.data(), stress);
  EXPECT_EQ(stress[0], 0);
  EXPECT_EQ(stress[1], -100);
}

}  // namespace law_in_c_test
}  // namespace talus
