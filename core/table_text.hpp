#pragma once
/// \file
/// Text tables written by other programs: reads the text and checks the line of column names.

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"

namespace twincell {

/// Text of a table without its byte order mark. The line ends \r\n and \r are converted to \n.
/// \throws InputError as read_text_file, and for UTF-16
std::string read_table_text(const std::filesystem::path& file);

/// Fields of a line of comma-separated values, as views into it, without the spaces around them. A field in
/// double quotes may hold commas; it is returned without the quotes around it, and a doubled quote in it
/// stays doubled (RFC 4180). A line that ends in a comma has an empty last field.
std::vector<std::string_view> fields_of(std::string_view line);

/// Checks the names of columns.
/// \throws InputError at `where` if a name occurs twice, if all names are numbers (the line of names is then
/// missing), or if the fields are separated by semicolons or tabs
void check_column_names(const std::vector<std::string>& names, const Where& where);

}  // namespace twincell
