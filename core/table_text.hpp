#pragma once
/// \file
/// Tables as other programs write them: the text, and what a line of column names must be.

#include <filesystem>
#include <string>
#include <vector>

#include "core/error.hpp"

namespace twincell {

/// The text of a table without a byte order mark, every line ended by \n, whether the file says \n, \r\n or
/// \r. \throws InputError as read_text_file, and for UTF-16
std::string read_table_text(const std::filesystem::path& file);

/// \throws InputError at `where` if a name is there twice, if all names are numbers, since the line of names
/// is missing, or if the fields are separated by semicolons or tabs
void check_column_names(const std::vector<std::string>& names, const Where& where);

}  // namespace twincell
