#pragma once
/// \file
/// The kinds of start: one table that the scene reader, the plan, `simulate`, `explain` and the help share.
///
/// To add a start: its function in a file of sim/start/ (start_lattice.cpp, start_random.cpp and
/// start_files.cpp hold the present ones) with a test, and here its enumerator, the declaration of the
/// function, and one row of the table. `twincell keys scene` prints its line of help.

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
  bool from_file = false;   ///< the beads are those of start.from; start.in_motion can keep their motion
  bool has_frames = false;  ///< the file has several frames; start.frame selects one
  /// Positions are drawn with start.seed, and velocities with start.velocity_scale, in a column of
  /// start.fraction.
  bool draws = false;
  bool sets_radii = false;  ///< the file sets the radii, so that beads.spread cannot
  Start (*make)(const Scene& scene, Progress& progress);
};

/// All kinds of start. The first is the default.
inline constexpr std::array kStarts = {
    StartRow{.value = StartKind::crystal_a,
             .word = "crystal_a",
             .help = "close-packed rows (3D: layers of the hexagonal stack) parallel to the plate",
             .make = crystal_a},
    StartRow{.value = StartKind::crystal_b,
             .word = "crystal_b",
             .help = "close-packed rows (3D: layers of the hexagonal stack) parallel to the side walls",
             .make = crystal_b},
    StartRow{.value = StartKind::random,
             .word = "random",
             .help = "random positions and velocities, from which the beads fall",
             .draws = true,
             .make = random_deposit},
    StartRow{.value = StartKind::trajectory,
             .word = "trajectory",
             .help = "a frame of a trajectory file",
             .from_file = true,
             .has_frames = true,
             .make = from_trajectory},
    StartRow{.value = StartKind::table,
             .word = "table",
             .help = "the beads of a CSV file",
             .from_file = true,
             .sets_radii = true,
             .make = from_table}};

/// The row of a kind of start.
constexpr const StartRow& start_row(StartKind kind) {
  return row_of(kStarts, kind);
}

}  // namespace twincell::sim
