#pragma once
/// \file
/// Escapes user strings (names of files, columns, runs, keys) for embedding in other languages, one function
/// per language. Also: analysis/report/gnuplot_text.hpp for gnuplot, json_text.hpp for JSON, toml_leaves.hpp
/// for TOML strings.

#include <cstddef>
#include <string>
#include <string_view>

namespace twincell {

/// Length in bytes of the UTF-8 character (RFC 3629) at the start of `s`; 0 if `s` does not start with a
/// valid one.
/// \pre `s` is not empty
std::size_t utf8_length(std::string_view s);

/// `text` on one line, for comments, headings and messages. Control characters, including newlines, become
/// spaces. Bytes that are not valid UTF-8 become U+FFFD.
std::string one_line(std::string_view text);

/// `text` as one word of a POSIX shell command line, quoted where necessary.
std::string shell_word(std::string_view text);

/// `text` escaped for use between HTML tags, or in an attribute value in single or double quotes. Bytes that
/// are not valid UTF-8 become U+FFFD.
std::string html_text(std::string_view text);

/// `text` as one field of a CSV table (RFC 4180), quoted where necessary.
std::string csv_field(std::string_view text);

}  // namespace twincell
