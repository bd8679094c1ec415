// The sentence of an error: position, complaint, full stop.

#include "core/error.hpp"

#include <gtest/gtest.h>

#include <string>

namespace twincell::error_test {
namespace {

TEST(Error, SentencesEndWithAFullStop) {
  EXPECT_STREQ(
      ConfigError({.file = "a.toml", .line = 3, .column = 2, .key = "drive.gamma"}, "is absent").what(),
      "a.toml:3:2: drive.gamma: is absent.");
  EXPECT_STREQ(InputError({.file = "a.csv", .key = {}}, "the file is empty.").what(),
               "a.csv: the file is empty.");
  EXPECT_STREQ(RunError("gnuplot failed on a.gp").what(), "gnuplot failed on a.gp.");
  for (const char* ended : {"is it one?", "no!", "it is (as said.)", "the text was cut…"})
    EXPECT_STREQ(RunError(ended).what(), ended);
  EXPECT_STREQ(RunError("2 pairs (1 of them apart)").what(), "2 pairs (1 of them apart).");
  EXPECT_STREQ(RunError("").what(), "");
}

TEST(Error, SentencesAreContinuedWithoutTheirFullStop) {
  EXPECT_EQ(without_full_stop(RunError("no bead").what()), "no bead");
  EXPECT_EQ(without_full_stop("which?"), "which?");
  EXPECT_EQ(without_full_stop(""), "");
}

}  // namespace
}  // namespace twincell::error_test
