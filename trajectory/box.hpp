#pragma once
/// \file
/// The cell: its corners, walls and periodic axes.

#include <Eigen/Core>
#include <array>
#include <cmath>
#include <cstddef>

namespace twincell {

using Vec3 = Eigen::Vector3d;

/// Axes: x to the right, z up (against gravity), y into the picture. A 2D cell is in the plane y = 0.
enum class Axis : int { x = 0, y = 1, z = 2 };

/// Boundary of the cell along one axis.
enum class Boundary {
  open,      ///< no boundary
  wall,      ///< hard walls at both ends (a lid that the bed never reaches counts as a wall)
  periodic,  ///< the two ends coincide
};

/// A cuboid cell whose side walls may be tilted. Lengths in sigma. The mean height of the plate is z = 0, so
/// that z_b(t) = A sin(omega t).
struct Box {
  int dimension = 2;          ///< 2: plane (x, z); 3
  Vec3 lower = Vec3::Zero();  ///< lower corner, sigma
  /// Upper corner, sigma; in 2D upper.y() - lower.y() is the gap of the glass plates.
  Vec3 upper = Vec3(1, 1, 1);
  std::array<Boundary, 3> boundary = {Boundary::wall, Boundary::open, Boundary::wall};
  /// Outward tilt of the left and the right wall about their feet, degrees. The feet move with the plate.
  std::array<double, 2> side_tilt = {0, 0};

  [[nodiscard]] Vec3 size() const { return upper - lower; }
  /// Whether the two ends of an axis coincide.
  [[nodiscard]] bool periodic(Axis axis) const {
    return boundary[static_cast<std::size_t>(axis)] == Boundary::periodic;
  }

  /// Minimum image of the separation `d` along the periodic axes.
  [[nodiscard]] Vec3 nearest_image(Vec3 d) const {
    for (int a = 0; a < 3; ++a)
      if (boundary[static_cast<std::size_t>(a)] == Boundary::periodic) {
        const double period = upper[a] - lower[a];
        // Most pairs are near, and std::round is a call of a library on processors without SSE 4.1.
        if (std::abs(d[a]) < 0.49 * period) continue;
        d[a] -= period * std::round(d[a] / period);
      }
    return d;
  }
  /// `r` wrapped into the cell along the periodic axes.
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
