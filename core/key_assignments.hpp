#pragma once
/// \file
/// Assignments "section.key=value", with which a user overrides keys of a file.

#include <string>
#include <vector>

namespace twincell {

/// The key of an assignment "section.key=value", without blanks around it.
std::string assigned_key(const std::string& assignment);

/// \throws ConfigError if --set gives one key two different values
void refuse_contradictory_assignments(const std::vector<std::string>& assignments);

}  // namespace twincell
