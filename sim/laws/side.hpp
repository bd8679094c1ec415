#pragma once
/// \file
/// What is at the sides of the cell: two hard walls, or the other side.

#include <cmath>
#include <string_view>

namespace twincell::sim {

/// Hard side walls.
struct SideWalls {
  static constexpr std::string_view kName = "hard side walls";
  static constexpr bool kWalls = true;
  double width = 0;
  [[nodiscard]] double separation(double dx) const { return dx; }
};

/// No side walls: x and x + width are the same place.
struct PeriodicSides {
  static constexpr std::string_view kName = "periodic sides";
  static constexpr bool kWalls = false;
  double width = 0;
  [[nodiscard]] double separation(double dx) const { return dx - width * std::round(dx / width); }
};

}  // namespace twincell::sim
