#pragma once
/// \file
/// Distances of discs from their nearest neighbours.

#include <cstddef>
#include <vector>

#include "imaging/disc/detection.hpp"

namespace twincell::imaging {

/// Distance of each disc from the nearest other one, px, ascending; of at most `most` discs, spread over the
/// list. Empty for fewer than two. Pure.
std::vector<double> nearest_distances(const std::vector<Detection>& discs, std::size_t most);

}  // namespace twincell::imaging
