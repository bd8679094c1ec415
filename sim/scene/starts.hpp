#pragma once
/// \file
/// The kinds of start: one table that the scene reader, the plan, `simulate`, `explain` and the help share.
///
/// To add a start: its function in a file sim/start/start_NAME.cpp with a test, and here its enumerator, the
/// declaration of the function, and one row of the table. `twincell keys scene` prints its line of
/// help.

#include <array>
#include <string_view>

#include "core/choice.hpp"
#include "core/progress.hpp"

namespace twincell::sim {

struct Scene;
struct Start;

/// Initial positions of the beads.
enum class StartKind { crystal_a, crystal_b, random, trajectory, table };

// The functions of the table; sim/start/start.hpp documents them.
Start crystal_a(const Scene& scene, Progress& progress);
Start crystal_b(const Scene& scene, Progress& progress);
Start random_deposit(const Scene& scene, Progress& progress);
Start from_trajectory(const Scene& scene, Progress& progress);
Start from_table(const Scene& scene, Progress& progress);

/// A kind of start and what it needs from the scene.
struct StartRow {
  StartKind value;
  std::string_view word;  ///< start.kind
  std::string_view help;
  bool from_file;   ///< the beads are those of start.from; start.in_motion can keep their motion
  bool has_frames;  ///< the file has several frames; start.frame selects one
  bool draws;  ///< positions are drawn with start.seed, and velocities with start.velocity_scale, in a column
               ///< of start.fraction
  bool sets_radii;  ///< the file sets the radii, so that beads.spread cannot
  Start (*make)(const Scene& scene, Progress& progress);
};

/// All kinds of start. The first is the default.
inline constexpr std::array kStarts = {
    StartRow{StartKind::crystal_a, "crystal_a",
             "close-packed rows (3D: layers of the hexagonal stack) parallel to the plate", false, false,
             false, false, crystal_a},
    StartRow{StartKind::crystal_b, "crystal_b",
             "close-packed rows (3D: layers of the hexagonal stack) parallel to the side walls", false, false,
             false, false, crystal_b},
    StartRow{StartKind::random, "random", "random positions and velocities, from which the beads fall", false,
             false, true, false, random_deposit},
    StartRow{StartKind::trajectory, "trajectory", "a frame of a trajectory file", true, true, false, false,
             from_trajectory},
    StartRow{StartKind::table, "table", "the beads of a CSV file", true, false, false, true, from_table}};

/// The row of a kind of start.
constexpr const StartRow& start_row(StartKind kind) {
  return row_of(kStarts, kind);
}

}  // namespace twincell::sim
