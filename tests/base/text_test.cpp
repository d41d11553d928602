#include "talus/base/text.hpp"

#include <gtest/gtest.h>

namespace talus::text_test {

TEST(Text, FindsWhatWasMeant) {
  const std::vector<std::string_view> keys = {"Phi_c", "phi_c", "dPhi", "spacing", "initial_stress", "no_slip"};
  EXPECT_EQ(most_alike("Phi_C", keys), "Phi_c");
  EXPECT_EQ(most_alike("phi_C", keys), "phi_c");
  EXPECT_EQ(most_alike("spaceing", keys), "spacing");
  EXPECT_EQ(most_alike("inital_stress", keys), "initial_stress");
  EXPECT_EQ(most_alike("stress", keys), "initial_stress");
  EXPECT_EQ(most_alike("noslip", keys), "no_slip");
}

TEST(Text, SuggestsNothingForSomethingElseAltogether) {
  EXPECT_EQ(most_alike("elephant", {"Phi_c", "spacing"}), "");
  EXPECT_EQ(most_alike("", {"Phi_c"}), "");
  EXPECT_EQ(most_alike("x", {}), "");
}

TEST(Text, CharactersThatSteerATerminalOrTurnTheDirectionOfTextAreShownAsNumbers) {
  EXPECT_EQ(printable("a\x1b[31mb\nc"), "a\\x1b[31mb\\nc");
  EXPECT_EQ(printable("\xc2\x9b"), "\\x9b");
  EXPECT_EQ(printable("safe\xe2\x80\xae txet\xe2\x81\xa6"), "safe\\u202e txet\\u2066");
  EXPECT_EQ(printable("\xe2\x80\x93 \xd7\xa9\xd7\x9c\xd7\x95\xd7\x9d"), "\xe2\x80\x93 \xd7\xa9\xd7\x9c\xd7\x95\xd7\x9d")
      << "a dash, and Hebrew";
}

TEST(Text, ListsWords) {
  EXPECT_EQ(any_of({"a"}), "`a`");
  EXPECT_EQ(any_of({"a", "b"}), "`a` or `b`");
  EXPECT_EQ(any_of({"a", "b", "c"}), "`a`, `b` or `c`");
}

TEST(Text, LinesAreBrokenAtBlanksAndAWordThatIsTooLongStaysWhole) {
  using Lines = std::vector<std::string>;
  EXPECT_EQ(broken_at_blanks("a column of sand", 8), (Lines{"a column", "of sand"}));
  EXPECT_EQ(broken_at_blanks("a column of sand", 7), (Lines{"a", "column", "of sand"}));
  EXPECT_EQ(broken_at_blanks("\xc3\xbc\xc3\xbc \xc3\xbc", 4), (Lines{"\xc3\xbc\xc3\xbc \xc3\xbc"}))
      << "letters, not bytes";
  EXPECT_EQ(broken_at_blanks("landslides of 2026", 6), (Lines{"landslides", "of", "2026"}));
  EXPECT_EQ(broken_at_blanks("", 6), Lines{""});
}

}  // namespace talus::text_test
