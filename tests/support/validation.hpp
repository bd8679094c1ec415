#pragma once
/// \file
/// One checked number: the expectation of a test and a row of docs/validation.md in one.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

namespace twincell::test {

/// What a number is checked against.
struct Outside {
  std::string id;      ///< row of the verification plan, "V1.2"
  std::string what;    ///< law or case, with what was varied
  double number;       ///< from outside the code
  double tolerance;    ///< absolute, both ways
  std::string source;  ///< closed form, paper, or peer
};

/// Expects |measured - number| <= tolerance, and prints the row
/// VALIDATION|id|test|what|number|measured|error|tolerance|source, from which `./run validation` makes the
/// page.
inline void validate(const Outside& outside, double measured) {
  const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
  const double error = measured - outside.number;
  std::printf("VALIDATION|%s|%s.%s|%s|%.7g|%.7g|%.1e|%.1e|%s\n", outside.id.c_str(), test.test_suite_name(),
              test.name(), outside.what.c_str(), outside.number, measured, error, outside.tolerance,
              outside.source.c_str());
  EXPECT_TRUE(std::abs(error) <= outside.tolerance)
      << outside.id << ", " << outside.what << ": measured " << measured << ", outside number "
      << outside.number << ", error " << error << ", tolerance " << outside.tolerance;
}

}  // namespace twincell::test
