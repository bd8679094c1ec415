#pragma once
/// \file
/// The values of a TOML table one by one, for configurations whose keys are the user's: axes of a sweep.

#include <string>
#include <vector>

namespace twincell {

/// A key that holds no table.
struct TomlLeaf {
  std::string path;                ///< "drive.gamma", below the table that was asked for
  std::string literal;             ///< its value as TOML
  bool list = false;               ///< whether the value is a list
  std::vector<std::string> items;  ///< values of the list as TOML; of a single value: itself
};

/// All leaves below table `table` of a document (of all of it, if that is empty), in the order of their
/// paths; none if there is no such table. \pre `text` is TOML, as Config::text() gives it
std::vector<TomlLeaf> toml_leaves(const std::string& text, const std::string& table);

/// `text` as a TOML literal in quotes.
std::string toml_quoted(const std::string& text);

}  // namespace twincell
