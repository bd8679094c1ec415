#pragma once
/// \file
/// Speeds at which the beads of a start meet.

#include <optional>
#include <vector>

#include "sim/scene/scene.hpp"
#include "sim/system/system.hpp"

namespace twincell::sim {

/// Speeds of the beads at the start of a run, sqrt(g sigma).
struct StartSpeeds {
  /// Root mean square of the relative velocity of two beads, sqrt(2 sum |v_i - <v>|^2/(n - 1)), or of the
  /// velocity of a bead, which meets a wall at rest, if that is larger.
  double typical = 0;
  /// Largest possible speed of two beads, the sum of the two largest |v_i - <v>|, or of a bead.
  double largest = 0;
};

/// The speeds at which the beads begin: those of a table or a start in motion, and drawn ones without
/// gravity. Absent for beads at rest, and for a bed that is drawn under gravity, whose velocities settling
/// takes away.
std::optional<StartSpeeds> speeds_of_start(const Scene& scene, const std::vector<Bead>& beads);

}  // namespace twincell::sim
