#pragma once
/// \file
/// Checks of the numbers on the command line. CLI11's own checks accept nan, since no comparison with it is
/// true, wrap negative numbers of unsigned options, and saturate numbers that are too large.

#include <CLI/CLI.hpp>

namespace twincell::cli {

/// A check for `->check()`: the number is above 0.
CLI::Validator above_zero();
/// A check for `->check()`: the number is 0 or above.
CLI::Validator zero_or_above();

/// Makes every option of the program that holds a real number refuse all but finite decimal numbers, and
/// every option that holds a whole number refuse all but whole numbers of its type. Call it after the last
/// option is added; the check runs before the options' own.
void check_numbers(CLI::App& program);

}  // namespace twincell::cli
