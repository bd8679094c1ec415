#pragma once
/// \file
/// What a paper leaves open: the height of a bed, the system of a figure, a convention. A figure is measured
/// under each of the alternatives, and its targets count once.

#include <cstddef>
#include <string>
#include <vector>

#include "reproduce/reproduction.hpp"

namespace twincell::reproduce {

/// The targets of a figure under one of the alternatives.
struct Alternative {
  std::string name;  ///< "N_l = 40", "3D rough"
  std::vector<Target> targets;
};

/// Index of the alternative that meets most targets, by pass and consistent; among equals the one that fails
/// fewest, then the first. \pre not empty
std::size_t meets_most(const std::vector<Alternative>& all);

/// The targets of one alternative. With several alternatives, each target states what was measured under all
/// of them, with the verdicts. \pre the alternatives have the same targets in the same order; counted <
/// all.size()
std::vector<Target> stating_all(const std::vector<Alternative>& all, std::size_t counted);

}  // namespace twincell::reproduce
