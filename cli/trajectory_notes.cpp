#include "cli/trajectory_notes.hpp"

#include <fmt/format.h>

#include "trajectory/trajectory_doubts.hpp"

namespace twincell::cli {

void note_trajectory(const Common& common, const TrajectorySource& trajectory) {
  constexpr std::size_t kWatchedFrames = 50;  // two cycles and more, and a small part of an analysis
  for (const std::string& doubt : doubts_of(trajectory, kWatchedFrames))
    note(common, fmt::format("{}: {}.", trajectory.name(), doubt));
}

}  // namespace twincell::cli
