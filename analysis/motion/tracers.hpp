#pragma once
/// \file
/// The line of tracer beads whose heights determine the phase of the bed.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell::analysis {

/// Slots of the tracers and how they were chosen.
struct TracerChoice {
  std::vector<std::size_t> slots;
  std::string how;
};

/// The user's choice of tracers: by id (the bead's slot), or by the initial heights of the beads.
struct TracerWish {
  std::vector<std::int64_t> ids = {};
  std::optional<std::array<double, 2>> band = {};  ///< heights [low, high] above the plate, sigma
};

/// The tracers of `wish`, else those marked in the trajectory (TrajectoryInfo::tracer), else, if none is
/// marked, a straight horizontal line at mid-height H/2 of the bed in `first` (Fortini & Huang 2015, app. B,
/// "initially at the centre"). In a crystal the line is the lattice row nearest to H/2, if the row within 0.2
/// sigma of its height has at least 3/4 of the beads that fit into the width. Otherwise it is, in each column
/// of width sigma, the bead nearest to H/2. H is measured from the lowest bead to the 99th percentile of the
/// heights, so that a single airborne bead does not shift it. Ties go to the lower slot.
/// \throws ConfigError for ids that are not beads of the trajectory or are named twice, for a band that is
/// empty or contains no bead, and for ids and a band together
TracerChoice choose_tracers(const TrajectoryInfo& info, const Frame& first, const TracerWish& wish = {});

/// The line of tracers at `above` sigma above mid-height, independent of any marked beads. Such lines show
/// how much a result depends on the choice of the line. Empty if the frame contains no bead.
TracerChoice line_of_tracers(const TrajectoryInfo& info, const Frame& first, double above);

}  // namespace twincell::analysis
