// Strengths stated for several stacks of one shaker, against the amplitudes of their plates.
#include "twin/stated_strengths.hpp"

#include <gtest/gtest.h>

namespace twincell::twin::stated_strengths_test {
namespace {

// A plate at omega^2/g = 4.37, as of a film with strengths 0.8, 1.4, 2.2.
std::vector<StackDrive> stacks(std::vector<double> gammas) {
  std::vector<StackDrive> drives;
  for (std::size_t i = 0; i < gammas.size(); ++i)
    drives.push_back({.name = "stack-" + std::to_string(i),
                      .gamma = gammas[i],
                      .amplitude = std::vector{0.183, 0.3204, 0.5038}[i],
                      .frames_per_cycle = 20});
  return drives;
}

TEST(Strengths, ThoseOfTheirStacksAreBelieved) {
  EXPECT_EQ(strengths_doubt(stacks({0.8, 1.4, 2.2})), "");
  EXPECT_EQ(strengths_doubt(stacks({0.82, 1.38, 2.25})), "") << "two digits";
  EXPECT_EQ(strengths_doubt(stacks({0.8})), "");
  std::vector<StackDrive> another = stacks({0.8, 1.4});
  another[1].gamma = 2.8;
  another[1].frames_per_cycle = 10;
  EXPECT_EQ(strengths_doubt(another), "") << "another frequency at the same frame rate";
  another = stacks({0.8, 2.8});
  another[1].amplitude = 0;
  EXPECT_EQ(strengths_doubt(another), "") << "the plate was not seen";
}

TEST(Strengths, ThoseOfOtherStacksAreNoted) {
  EXPECT_EQ(
      strengths_doubt(stacks({1.4, 0.8, 2.2})),
      "Gamma/A, which is omega^2/g and the same at one frequency, is 2.5 in stack-1 and 7.65 in stack-0; "
      "if the frequency was not changed, a strength is wrong or belongs to another stack: in the order "
      "0.8,1.4,2.2 they agree with the amplitudes.");
  const std::string shifted = strengths_doubt(stacks({0.5, 0.8, 1.4}));
  EXPECT_NE(shifted.find("is 2.5 in stack-1 and 2.78 in stack-2"), std::string::npos) << shifted;
  EXPECT_EQ(shifted.find("in the order"), std::string::npos) << shifted;
}

}  // namespace
}  // namespace twincell::twin::stated_strengths_test
