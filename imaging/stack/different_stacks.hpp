#pragma once
/// \file
/// Several stacks that are analysed together.

#include <filesystem>
#include <vector>

namespace twincell::imaging {

/// Opens each stack and reads its first frames.
/// \throws InputError if one cannot be read
/// \throws ConfigError if two begin with the same eight pictures (all, if they have fewer): one film counted
/// twice makes intervals too narrow. Films of a real camera differ by their noise.
void require_different_stacks(const std::vector<std::filesystem::path>& stacks);

}  // namespace twincell::imaging
