#include "core/terminal_text.hpp"

#include <gtest/gtest.h>

namespace twincell::terminal_text_test {
namespace {

TEST(TerminalText, AShortLineStaysAsItIs) {
  EXPECT_EQ(fit_columns("a  b\n\n  c d\n", 8), "a  b\n\n  c d\n");
}

TEST(TerminalText, ALongLineBreaksAtSpacesWithinTheWidth) {
  EXPECT_EQ(fit_columns("one two three four\n", 9), "one two\n    three\n    four\n");
  EXPECT_EQ(fold_line("k = 1  # one two", 12, "   # "), "k = 1  # one\n   # two\n");
}

TEST(TerminalText, TheContinuationBeginsBelowTheLastColumn) {
  EXPECT_EQ(fit_columns("  name  on  a long reason\n", 24), "  name  on  a long\n            reason\n");
}

TEST(TerminalText, AWordThatIsTooLongStaysWhole) {
  EXPECT_EQ(fit_columns("a/long/path end\n", 6), "a/long/path\n    end\n");
  EXPECT_EQ(fit_columns("a/long/path\n", 6), "a/long/path\n");
}

TEST(TerminalText, ACharacterOfSeveralBytesIsOneColumn) {
  EXPECT_EQ(columns_of("σ ≤ 10⁶"), 7U);
  EXPECT_EQ(fit_columns("σσσ σσσ\n", 7), "σσσ σσσ\n");
}

}  // namespace
}  // namespace twincell::terminal_text_test
