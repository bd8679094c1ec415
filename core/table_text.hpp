#pragma once
/// \file
/// Text tables written by other programs: reads the text and checks the line of column names.

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

#include "core/error.hpp"

namespace twincell {

/// Text of a table without its byte order mark. Line ends \r\n and \r are converted to \n.
/// \throws InputError as read_text_file, for UTF-16, and for text with zero bytes
std::string read_table_text(const std::filesystem::path& file);

/// Fields of a line of comma-separated values, as views into it, without the spaces around them. A field in
/// double quotes may hold commas; it is returned without the quotes around it, and a doubled quote in it
/// stays doubled (RFC 4180). A line that ends in a comma has an empty last field.
std::vector<std::string_view> fields_of(std::string_view line);

/// The same as strings.
std::vector<std::string> field_texts(std::string_view line);

/// The further column that has the name of the first one; nullopt if there is none. pandas writes the index
/// of a table as the first column. If a column of the table has the name of the index, the name occurs twice,
/// with equal values (require_same_index).
std::optional<std::size_t> twin_of_index(const std::vector<std::string>& names);

/// \param twin twin_of_index of the names
/// \throws InputError with the line of `where` if the two fields differ
void require_same_index(const std::vector<std::string_view>& fields, std::optional<std::size_t> twin,
                        const std::string& name, const Where& where);

/// Checks the names of columns.
/// \throws InputError at `where` if a name occurs twice, if all names are numbers (the line of names is then
/// missing), or if the fields are separated by semicolons or tabs
void check_column_names(const std::vector<std::string>& names, const Where& where);

}  // namespace twincell
