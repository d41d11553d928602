#include "talus/figure/verdict.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace talus::verdict_test {

/// A statement that a number is at least 1.
Statement at_least_one() {
  Statement s;
  s.number = "formula";
  s.at_least = 1;
  return s;
}

TEST(Verdict, AStatementHoldsInTheFirstReadingOrOnlyInAnotherOrInNone) {
  EXPECT_EQ(finding_of(at_least_one(), {{1, 0}, {true, false}}), Finding::holds);
  EXPECT_EQ(finding_of(at_least_one(), {{0, 1}, {false, true}}), Finding::in_another);
  EXPECT_EQ(finding_of(at_least_one(), {{0, 0}, {false, false}}), Finding::fails);
  EXPECT_EQ(finding_of(Statement(), {{NAN, NAN}, {false, false}}), Finding::unchecked);
}

TEST(Verdict, FindingsOfAFigureAreCounted) {
  RemadeFigure figure;
  figure.spec.statements = {at_least_one(), at_least_one(), Statement()};
  figure.result.verdicts = {{{1}, {true}}, {{0}, {false}}, {{NAN}, {false}}};
  EXPECT_EQ(count_findings(figure), (FindingCounts{1, 0, 1, 1}));
}

TEST(Verdict, WordsForRangesAndNumbers) {
  Statement s = at_least_one();
  EXPECT_EQ(range_in_words(s), "at least 1");
  s.at_most = 2.5;
  EXPECT_EQ(range_in_words(s), "1 to 2.5");
  s.at_least.reset();
  EXPECT_EQ(range_in_words(s), "at most 2.5");
  EXPECT_EQ(range_in_words(Statement()), "");
  EXPECT_EQ(number_in_words(0.12345), "0.1235");
  EXPECT_EQ(number_in_words(NAN), "&ndash;");
}

}  // namespace talus::verdict_test
