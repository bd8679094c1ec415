#pragma once
/// \file
/// Packings of discs that do not overlap, inside a rectangle. Lengths in px, y down.

#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "imaging/benchmark/picture.hpp"

namespace twincell::imaging::rendered {

/// A uniformly distributed number in [a, b).
double uniform(std::mt19937_64& random, double a, double b);

/// One disc per radius, px, on a square grid over the whole rectangle, each disc displaced at random within
/// the free space of its cell. Nearest neighbours are at least two px apart.
std::vector<Disc> sparse(const std::vector<double>& radii, cv::Rect2d room, std::mt19937_64& random);

/// Up to `count` discs of one radius, px, in a hexagonal crystal, filled from the floor of the rectangle
/// upwards. The rows are rotated by 7 degrees, so that every sub-pixel position occurs.
std::vector<Disc> hexagonal(std::size_t count, double radius, cv::Rect2d room, std::mt19937_64& random);

/// Drop and roll (Visscher and Bolsterli, Nature 239, 504 (1972)): each disc falls at a random horizontal
/// position and rolls over others until two discs, one disc and a wall, or the floor support it. Contacts are
/// exact, and discs do not overlap.
/// \param radii px
/// \param room px
std::vector<Disc> deposited(const std::vector<double>& radii, cv::Rect2d room, std::mt19937_64& random);

}  // namespace twincell::imaging::rendered
