#pragma once
/// \file
/// The cell: its corners, walls and periods.

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

namespace twincell {

using Vec3 = Eigen::Vector3d;

/// x to the right, z up (against gravity), y into the picture. A 2D cell lies in the plane y = 0.
enum class Axis : int { x = 0, y = 1, z = 2 };

/// What limits the cell along one axis.
enum class Boundary {
  open,      ///< nothing
  wall,      ///< hard walls at both ends (the top of a bed that never reaches its lid counts as wall)
  periodic,  ///< the far end is the near end
};

/// A cuboid cell, whose side walls may lean, in the frame in which the plate's mean height is z = 0 (so
/// z_b(t) = A sin(omega t)); lengths in sigma.
struct Box {
  int dimension = 2;          ///< 2: plane (x, z); 3
  Vec3 lower = Vec3::Zero();  ///< lower corner, sigma
  Vec3 upper =
      Vec3(1, 1, 1);  ///< upper corner, sigma; in 2D upper.y() - lower.y() is the gap of the glass plates
  std::array<Boundary, 3> boundary = {Boundary::wall, Boundary::open, Boundary::wall};
  /// Degrees by which the left and the right wall lean outward about their feet, which ride on the plate.
  std::array<double, 2> side_tilt = {0, 0};

  [[nodiscard]] Vec3 size() const { return upper - lower; }
  [[nodiscard]] bool periodic(Axis axis) const {
    return boundary[static_cast<std::size_t>(axis)] == Boundary::periodic;
  }

  /// Shortest of the images of the separation `d`, periodic axes only.
  [[nodiscard]] Vec3 nearest_image(Vec3 d) const {
    for (int a = 0; a < 3; ++a)
      if (boundary[static_cast<std::size_t>(a)] == Boundary::periodic) {
        const double period = upper[a] - lower[a];
        d[a] -= period * std::round(d[a] / period);
      }
    return d;
  }
  /// `r` brought back between the corners, periodic axes only.
  [[nodiscard]] Vec3 wrap(Vec3 r) const {
    for (int a = 0; a < 3; ++a)
      if (boundary[static_cast<std::size_t>(a)] == Boundary::periodic) {
        const double period = upper[a] - lower[a];
        r[a] -= period * std::floor((r[a] - lower[a]) / period);
      }
    return r;
  }
};

}  // namespace twincell
