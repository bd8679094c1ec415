// "Did you mean": the known word that is nearest to a wrong one.

#include "core/nearest_word.hpp"

#include <gtest/gtest.h>

namespace twincell::nearest_word_test {

TEST(NearestWord, AnotherCaseIsNearerThanAnotherLetter) {
  EXPECT_EQ(nearest_word("s_q", {"s_k", "s_b", "S_q"}), "S_q");
  EXPECT_EQ(nearest_word("t_BAR", {"T_bar_z", "T_bar"}), "T_bar");
}

TEST(NearestWord, HalfOfAShortWordIsNoMisprint) {
  EXPECT_EQ(nearest_word("gama", {"gamma", "omega"}), "gamma");
  EXPECT_EQ(nearest_word("xy", {"ab"}), "");
  EXPECT_EQ(nearest_word("CELL.toml", {"scene.toml"}), "");
}

}  // namespace twincell::nearest_word_test
