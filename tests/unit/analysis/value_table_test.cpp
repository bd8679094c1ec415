// Numbers of beads from a table of the user's.

#include "analysis/colouring/value_table.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/complaint.hpp"
#include "tests/support/put_file.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::analysis::value_table_test {
namespace {

TEST(ValueTable, GivesTheNumbersOfItsRowsAndNoneElsewhere) {
  const TemporaryFolder folder;
  put_file(folder / "strain.csv", "particle,frame,strain\n1,0,0.25\n2,0,-3\n0,2,7\n1,2,\n");
  const ValueTable table(folder / "strain.csv", 3, 3);
  EXPECT_EQ(table.name(), "strain");
  EXPECT_TRUE(std::isnan(table.of(0)[0]));
  EXPECT_EQ(table.of(0)[1], 0.25);
  EXPECT_EQ(table.of(0)[2], -3);
  EXPECT_TRUE(std::isnan(table.of(1)[1]));
  EXPECT_EQ(table.of(2)[0], 7);
  EXPECT_TRUE(std::isnan(table.of(2)[1]));
}

TEST(ValueTable, RefusesWhatItCannotPlace) {
  const TemporaryFolder folder;
  const auto said = [&](const std::string& text) {
    put_file(folder / "t.csv", text);
    return complaint_of([&] { (void)ValueTable(folder / "t.csv", 3, 3); });
  };
  const auto has = [](const std::string& all, const std::string& part) {
    return all.find(part) != std::string::npos;
  };
  EXPECT_TRUE(has(said("frame,particle,value\n0,3,1\n"),
                  "particle: row 1: 3 is not a whole number from 0 to 2, the particles of the trajectory"));
  EXPECT_TRUE(has(said("frame,particle,value\n0.5,1,1\n"), "frame: row 1: 0.5 is not a whole number"));
  EXPECT_TRUE(
      has(said("frame,particle,value\n0,1,1\n0,1,2\n"), "row 2: particle 1 has a second number in frame 0"));
  EXPECT_TRUE(has(said("frame,particle,a,b\n0,1,1,2\n"), "several could be meant: a, b."));
  EXPECT_TRUE(has(said("frame,particle\n0,1\n"), "no column of numbers beside frame and particle."));
  EXPECT_TRUE(has(said("frame,bead,value\n0,1,1\n"), "particle"));
  EXPECT_TRUE(has(said("frame,particle,value\n0,1,red\n"), "value"));
}

}  // namespace
}  // namespace twincell::analysis::value_table_test
