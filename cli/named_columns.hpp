#pragma once
/// \file
/// The option --columns of the verbs that read tables of other programs.

#include <map>
#include <string>
#include <vector>

namespace twincell::cli {

/// Names of columns by quantity.
/// \throws ConfigError for a word that is not QUANTITY=NAME, or a quantity named twice
std::map<std::string, std::string> named_columns(const std::vector<std::string>& words);

}  // namespace twincell::cli
