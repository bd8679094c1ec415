#pragma once
/// \file
/// Lists the values of a TOML table, for tables whose keys the user chooses, such as the axes of a sweep.

#include <string>
#include <vector>

namespace twincell {

/// A key whose value is not a table.
struct TomlLeaf {
  std::string path;                ///< "drive.gamma", relative to the requested table
  std::string literal;             ///< its value as TOML
  bool list = false;               ///< whether the value is a list
  std::vector<std::string> items;  ///< elements of the list as TOML; for a single value, the value itself
};

/// All leaves below table `table` of a TOML document, or of the whole document if `table` is empty, in the
/// order of their paths. Empty if there is no such table.
/// \pre `text` is valid TOML, as Config::text() returns it
std::vector<TomlLeaf> toml_leaves(const std::string& text, const std::string& table);

/// `text` as a quoted TOML string.
std::string toml_quoted(const std::string& text);

}  // namespace twincell
