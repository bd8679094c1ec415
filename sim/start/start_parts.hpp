#pragma once
/// \file
/// What the kinds of start have in common. Not for use outside start_*.cpp.

#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "sim/scene/scene.hpp"
#include "sim/system/system.hpp"

namespace twincell::sim {

// Of close packing, in diameters.
inline constexpr double kRowSpacing = 0.86602540378443865;    ///< sqrt(3)/2: rows in a layer
inline constexpr double kLayerSpacing = 0.81649658092772603;  ///< sqrt(2/3): layers
inline constexpr double kLayerShift =
    0.28867513459481288;  ///< 1/sqrt(12): from a row to the hollows beside it

/// A bead at rest.
Bead bead_at(const Scene& scene, double radius, double mass, const Vec3& r);
/// The same, of the scene's material.
Bead bead_at(const Scene& scene, double radius, const Vec3& r);
/// The scene's intruder, which it must have.
Bead intruder_of(const Scene& scene);

/// Positions, sizes and perturbations draw from streams of their own: one of them does not change the others.
enum class Stream : std::uint64_t { positions = 0, sizes = 1, perturbation = 2 };
std::mt19937_64 engine_of(const Scene& scene, Stream stream);
/// Uniform in [0, 1) from the 53 high bits: the same numbers with every standard library.
double uniform(std::mt19937_64& engine);

/// How far a bead reaches into the wall it is deepest in; negative: how far it is from the nearest.
struct WallOverlap {
  double depth = -HUGE_VAL;
  const Wall* wall = nullptr;
};
WallOverlap deepest_wall(const std::vector<Wall>& walls, const Vec3& r, double radius);

/// Height that beads may not reach, be it a lid or the next period.
double ceiling_of(const Scene& scene);
/// The plane y of a lattice of constant d that has room for one row; nothing if there is room for more.
std::optional<double> only_row(const Scene& scene, double d);
/// "a cell 20 wide, 5 deep, 10 high", as far as it is limited.
std::string describe_cell(const Scene& scene);

}  // namespace twincell::sim
