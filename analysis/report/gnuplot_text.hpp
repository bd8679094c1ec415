#pragma once
/// \file
/// Conversion of strings from outside the program (a column, a file, a run, a unit) into gnuplot text, which
/// no other code may put into a script, and of numbers into entries of a data file.

#include <string>
#include <string_view>

namespace twincell::analysis {

/// `text` for use between single quotes, escaped so that gnuplot's enhanced text mode shows it literally.
/// Special characters of enhanced text get a backslash. Quotes and backquotes become typographic quotes, so
/// that they cannot end the string. Control characters, including newlines, become spaces. Bytes that are not
/// valid UTF-8 become U+FFFD.
std::string gnuplot_text(std::string_view text);

/// As gnuplot_text, for text that is followed by `noenhanced`: without backslashes.
std::string gnuplot_plain_text(std::string_view text);

/// As gnuplot_text, with the text after the first underscore as a subscript: `T_z` becomes `T_{z}`.
std::string gnuplot_symbol(std::string_view name);

/// A formula in words as it is printed: subscripts and exponents, Greek letters, `ln_C` as the logarithm of
/// C. `ln y = ln_C + alpha ln x` becomes `ln y = ln C + α ln x`, and `x^-b` `x^{-b}`.
std::string gnuplot_formula(std::string_view formula);

/// A number of a data file with six digits, or `?`, which gnuplot takes for a missing one, if `value` is not
/// finite.
std::string gnuplot_number(double value);

/// True if `name` can be a figure's file name in a script: letters, digits, `_`, `-`, `.` of ASCII, not
/// beginning with `-` or `.`.
bool is_figure_name(std::string_view name);

}  // namespace twincell::analysis
