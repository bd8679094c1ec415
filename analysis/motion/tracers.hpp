#pragma once
/// \file
/// The line of tracer beads whose heights tell the phases apart, and the plate under them.

#include <array>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// Slots of the tracers and how they were found.
struct TracerChoice {
  std::vector<std::size_t> slots;
  std::string how;
};

/// A user's own choice: by id (the bead's slot), or by where the beads begin.
struct TracerWish {
  std::vector<std::int64_t> ids = {};
  std::optional<std::array<double, 2>> band = {};  ///< heights [low, high] above the plate, sigma
};

/// The tracers of `wish`; else those the trajectory names (TrajectoryInfo::tracer); otherwise a straight
/// horizontal line at mid-height H/2 of the bed in `first` (Fortini & Huang 2015, app. B, "initially at the
/// centre"): the lattice row nearest to H/2 if a row within 0.2 sigma of one height holds at least 3/4 of the
/// width's beads (crystal), else for each column of width sigma the bead nearest to H/2. H from the lowest
/// bead to the 99th percentile, so that one high flyer does not shift it. Ties: the lower slot. \throws
/// ConfigError for ids that are not beads of the trajectory or are named twice, a band that is empty or holds
/// no bead, ids and a band together
TracerChoice choose_tracers(const TrajectoryInfo& info, const Frame& first, const TracerWish& wish = {});

/// The same choice, made `above` sigma over mid-height, whatever beads are marked: another line by which to
/// see what the choice of the line is worth. Empty if the frame holds no bead.
TracerChoice line_of_tracers(const TrajectoryInfo& info, const Frame& first, double above);

/// Height of the plate in `frame`, sigma: measured if the trajectory has it, else of the drive at the frame's
/// phase (0 for a horizontal drive). Absent if neither is known.
std::optional<double> plate_height(const TrajectoryInfo& info, const Frame& frame);

}  // namespace twincell
