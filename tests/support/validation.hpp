#pragma once
/// \file
/// One checked value: both the expectation of a test and a row of docs/validation.md.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <string>

namespace twincell::test {

/// Independent reference for a checked value.
struct Outside {
  std::string id;      ///< row of the verification plan, "V1.2"
  std::string what;    ///< law or case, with what was varied
  double number;       ///< from outside the code
  double tolerance;    ///< absolute, in both directions
  std::string source;  ///< closed form, paper, or independent program
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

/// Independent reference that gives only a lower and an upper bound.
struct OutsideBounds {
  std::string id, what;
  double least, most;
  std::string source;
};

/// Expects least <= measured <= most, and prints the row of validate() with "least to most" for the number.
inline void validate_bound(const OutsideBounds& outside, double measured) {
  const testing::TestInfo& test = *testing::UnitTest::GetInstance()->current_test_info();
  std::printf("VALIDATION|%s|%s.%s|%s|%.7g to %.7g|%.7g|–|bounds|%s\n", outside.id.c_str(),
              test.test_suite_name(), test.name(), outside.what.c_str(), outside.least, outside.most,
              measured, outside.source.c_str());
  EXPECT_TRUE(measured >= outside.least && measured <= outside.most)
      << outside.id << ", " << outside.what << ": measured " << measured << ", bounds " << outside.least
      << " and " << outside.most;
}

}  // namespace twincell::test
