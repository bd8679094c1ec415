#pragma once
/// \file
/// Presets: scenes of the papers as TOML, which the keys of a user's file override.

#include <string>
#include <utility>
#include <vector>

namespace twincell::sim {

/// Name and text of every preset.
const std::vector<std::pair<std::string, std::string>>& presets();

/// Their names.
std::vector<std::string> preset_names();

}  // namespace twincell::sim
