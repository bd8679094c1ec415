#pragma once
/// \file
/// The one place where a string from outside the program (a column, a file, a run, a unit) becomes gnuplot
/// text.

#include <string>
#include <string_view>

namespace twincell {

/// `text` as gnuplot's enhanced text shows it literally, for a place between single quotes: marks of enhanced
/// text get a backslash; quotes and backquotes become typographic ones, so that nothing ends the string;
/// control characters (newlines too) become spaces; bytes that are no UTF-8 become U+FFFD.
std::string gnuplot_text(std::string_view text);

/// The same for text that is followed by `noenhanced`: no backslashes.
std::string gnuplot_plain_text(std::string_view text);

/// gnuplot_text with what follows the first underscore set as an index: `T_z` becomes `T_{z}`.
std::string gnuplot_symbol(std::string_view name);

/// True if `name` can be a figure's file name in a script: letters, digits, `_`, `-`, `.` of ASCII, not
/// beginning with `-` or `.`.
bool is_figure_name(std::string_view name);

}  // namespace twincell
