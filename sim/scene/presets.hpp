#pragma once
/// \file
/// Scenes of the papers, as TOML over which a user's file is laid.

#include <string>
#include <utility>
#include <vector>

namespace twincell::sim {

/// Name and text of every preset.
const std::vector<std::pair<std::string, std::string>>& presets();

}  // namespace twincell::sim
