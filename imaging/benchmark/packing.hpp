#pragma once
/// \file
/// Where discs lie that cannot overlap. Lengths in px, y down, inside a rectangle.

#include <opencv2/core.hpp>
#include <random>
#include <vector>

#include "imaging/benchmark/picture.hpp"

namespace twincell::rendered {

/// One disc per radius, nearest neighbours at least two px apart: a square grid over the whole room, each
/// disc moved at random by what is free.
std::vector<Disc> sparse(const std::vector<double>& radii, cv::Rect2d room, std::mt19937_64& random);

/// `count` discs in contact with six others, from the room's floor up; rows turned by 7 degrees, so that
/// every sub-pixel place occurs.
std::vector<Disc> hexagonal(std::size_t count, double radius, cv::Rect2d room, std::mt19937_64& random);

/// Drop and roll (Visscher and Bolsterli, Nature 239, 504 (1972)): each disc falls at a random place and
/// rolls over others until two of them, or one and a wall, or the floor carry it. Contacts are exact, nothing
/// overlaps.
std::vector<Disc> deposited(const std::vector<double>& radii, cv::Rect2d room, std::mt19937_64& random);

}  // namespace twincell::rendered
