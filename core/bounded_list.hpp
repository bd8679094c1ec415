#pragma once
/// \file
/// Lists of numbers of a configuration that have bounds.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

#include "core/config.hpp"

namespace twincell {

/// A list of exactly `count` numbers, each within bounds.
/// \throws ConfigError as ConfigSection::numbers and require_range
std::optional<std::vector<double>> numbers_in(const ConfigSection& section, const std::string& key,
                                              std::size_t count, double lower, double upper);

}  // namespace twincell
