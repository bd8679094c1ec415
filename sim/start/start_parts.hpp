#pragma once
/// \file
/// Functions shared by the kinds of start. For use in start_*.cpp only.

#include <cmath>
#include <cstdint>
#include <optional>
#include <random>
#include <string>
#include <vector>

#include "sim/scene/scene.hpp"
#include "sim/system/system.hpp"

namespace twincell::sim {

// Spacings of close packing, in diameters.
inline constexpr double kRowSpacing = 0.86602540378443865;    ///< sqrt(3)/2: between rows in a layer
inline constexpr double kLayerSpacing = 0.81649658092772603;  ///< sqrt(2/3): between layers
inline constexpr double kLayerShift = 0.28867513459481288;    ///< 1/sqrt(12): from a row to a hollow

/// A bead at rest with its centre at r (radius and r in sigma, mass in m).
Bead bead_at(const Scene& scene, double radius, double mass, const Vec3& r);
/// A bead at rest, of the material of the scene.
Bead bead_at(const Scene& scene, double radius, const Vec3& r);
/// The intruder of the scene, which must exist.
Bead intruder_of(const Scene& scene);

/// Positions, sizes and perturbations use separate random streams, so a change of one does not affect the
/// others.
enum class Stream : std::uint64_t { positions = 0, sizes = 1, perturbation = 2 };
/// The random numbers of one stream, from their beginning; their seed is scene.seed + 0x9E3779B97F4A7C15
/// stream.
std::mt19937_64 engine_of(const Scene& scene, Stream stream);
/// Uniform in [0, 1), from the 53 high bits, so the numbers are the same with every standard library.
double uniform(std::mt19937_64& engine);

/// Depth of a bead in the wall that it overlaps most; if negative, minus the distance to the nearest wall.
struct WallOverlap {
  double depth = -HUGE_VAL;  ///< sigma
  const Wall* wall = nullptr;
};
/// The wall that a bead with centre r overlaps most, sigma.
WallOverlap deepest_wall(const std::vector<Wall>& walls, const Vec3& r, double radius);

/// Largest height that beads may reach, sigma: the lid, or the period in z; infinite without either.
double ceiling_of(const Scene& scene);
/// The plane y of the only row, sigma, if a lattice of constant d has room for just one row; otherwise
/// nothing.
std::optional<double> only_row(const Scene& scene, double d);
/// The cell in words, with its finite dimensions: "a cell 20 wide, 5 deep, 10 high".
std::string describe_cell(const Scene& scene);

}  // namespace twincell::sim
