#include "talus/base/units.hpp"

#include <gtest/gtest.h>

#include <numbers>
#include <tuple>

namespace talus::units_test {

double si(const char* text, const char* unit) {
  const auto value = to_si(text, unit);
  EXPECT_TRUE(std::holds_alternative<double>(value)) << text << ": " << std::get<1>(value);
  return std::get<double>(value);
}
std::string refusal(const char* text, const char* unit) {
  const auto value = to_si(text, unit);
  EXPECT_TRUE(std::holds_alternative<std::string>(value))
      << text << " was taken for " << std::get<0>(value) << " " << unit;
  return std::holds_alternative<std::string>(value) ? std::get<std::string>(value) : "";
}

TEST(Units, AreConvertedToSI) {
  EXPECT_DOUBLE_EQ(si("2 mm", "m"), 2e-3);
  EXPECT_DOUBLE_EQ(si("-40mm", "m"), -0.04);
  EXPECT_DOUBLE_EQ(si(" 1e-1 cm ", "m"), 1e-3);
  EXPECT_DOUBLE_EQ(si("100 kPa", "Pa"), 1e5);
  EXPECT_DOUBLE_EQ(si("9.81 m/s2", "m/s2"), 9.81);
  EXPECT_DOUBLE_EQ(si("9.81 m/s^2", "m/s2"), 9.81);
  EXPECT_DOUBLE_EQ(si("20.9 deg", "rad"), 20.9 * std::numbers::pi / 180);
  EXPECT_DOUBLE_EQ(si("0.3 rad", "rad"), 0.3);
  EXPECT_DOUBLE_EQ(si("2.5 g/cm3", "kg/m3"), 2500);
  EXPECT_DOUBLE_EQ(si("50 1/s2", "1/s2"), 50);
  EXPECT_DOUBLE_EQ(si("1e-4 s-1", "1/s"), 1e-4);
  EXPECT_DOUBLE_EQ(si("+3 ms", "s"), 3e-3);
}

TEST(Units, OfTheWrongKindAreRefusedWithAnExample) {
  EXPECT_EQ(refusal("1.0 kPa", "m"), "not a length; write \"2 mm\"");
  for (const char* no_unit : {"3 mm 2", "3 mm0 mm", "3 mm3 mm-2 2", "3 4 mm", "3 2mm", "3 mm*2", "3 10 mm"})
    EXPECT_EQ(refusal(no_unit, "m"), "not a length; write \"2 mm\"") << no_unit;
  // not even as its reciprocal
  EXPECT_EQ(refusal("2 s", "1/s"), "not a rate; write \"0.1 1/s\"");
  EXPECT_EQ(refusal("2 1/s", "s"), "not a time; write \"0.5 s\"");
  EXPECT_NE(refusal("20", "rad").find("lacks its unit"), std::string::npos);
  EXPECT_NE(refusal("2 furlongish", "m").find("unknown unit `furlongish`"), std::string::npos);
}

TEST(Units, AnAngleIsNoNumberAndANumberNoAngle) {
  refusal("5 %", "rad");
  refusal("5 deg/s", "1/s");
}

TEST(Units, RubbishIsRefused) {
  for (const char* text :
       {"", " ", "mm", "two mm", "3 4 mm", "nan m", "inf m", "1e999 m", "0x10 m", "2 mm mm", "--2 mm", "2,5 mm"})
    refusal(text, "m");
}

TEST(Units, OfLengthsFitTheSizeOfWhatIsMeasured) {
  for (const auto& [size, name, length] : std::initializer_list<std::tuple<double, const char*, double>>{
           {0.48, "mm", 1e-3}, {1.9, "mm", 1e-3}, {2, "m", 1}, {4900, "m", 1}, {5000, "km", 1e3}}) {
    EXPECT_EQ(length_unit_for(size).name, name) << size;
    EXPECT_EQ(length_unit_for(size).length, length) << size;
  }
}

TEST(Units, AreWrittenBackReadably) {
  EXPECT_EQ(with_unit(0.002, "m"), "2 mm");
  EXPECT_EQ(with_unit(2, "m"), "2 m");
  EXPECT_EQ(with_unit(1e5, "Pa"), "100 kPa");
  EXPECT_EQ(with_unit(2.1e11, "Pa"), "210 GPa");
  EXPECT_EQ(with_unit(20.9 * std::numbers::pi / 180, "rad"), "20.9 deg");
  EXPECT_EQ(with_unit(0.38, "1"), "0.38");
}

}  // namespace talus::units_test
