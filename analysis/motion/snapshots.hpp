#pragma once
/// \file
/// Snapshots: frames of a run that are kept for display.

#include <cstddef>
#include <vector>

#include "analysis/neighbours/bond_orientational_order.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::analysis {

/// One frame of a run with the data that a picture needs.
struct Snapshot {
  Frame frame;
  BondOrder order;
  /// [n_beads] number of Voronoi neighbours of an enclosed bead, 5 and 7 for disclinations; 0 for a surface
  /// bead (defects.hpp). Empty if the box is periodic along x and too narrow for Voronoi cells.
  std::vector<std::size_t> coordination;
  double plate = 0;  ///< height of the plate, sigma; the floor of the box if unknown
};

/// Frame `index` with its bond order.
/// \param cutoff neighbour cutoff, sigma
Snapshot snapshot(const TrajectorySource& trajectory, std::size_t index, double cutoff);

/// At most `most` frame indices, in order, that show both the slow and the fast motion. Half of them are at
/// phase 0, evenly spread over the cycles from the first to the last; the others are from the last whole
/// cycle, evenly spread over its phases. Without phases, they are evenly spread over all frames.
/// \pre most >= 2
std::vector<std::size_t> representative_frames(const TrajectorySource& trajectory, std::size_t most);

}  // namespace twincell::analysis
