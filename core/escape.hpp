#pragma once
/// \file
/// Strings of a user's (names of files, columns, runs, keys) inside other languages: one function for each.
/// For gnuplot: analysis/report/gnuplot_text.hpp; for JSON: json_text.hpp; for strings of TOML:
/// toml_leaves.hpp.

#include <cstddef>
#include <string>
#include <string_view>

namespace twincell {

/// Length in bytes of the UTF-8 character (RFC 3629) at the beginning of `s`; 0 if there is none. \pre not
/// empty
std::size_t utf8_length(std::string_view s);

/// `text` on one line, for comments, headings and messages: control characters (newlines too) become spaces,
/// bytes that are no UTF-8 become U+FFFD.
std::string one_line(std::string_view text);

/// One word of a POSIX shell's command line that stands for `text` and nothing else.
std::string shell_word(std::string_view text);

/// Text between HTML tags, or in an attribute in either kind of quotes. Bytes that are no UTF-8 become
/// U+FFFD.
std::string html_text(std::string_view text);

/// One field of a CSV table (RFC 4180).
std::string csv_field(std::string_view text);

}  // namespace twincell
