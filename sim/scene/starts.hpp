#pragma once
/// \file
/// The kinds of start: one table that the scene reader, the plan, `simulate`, `explain` and the help share.
///
/// To add a start: here its enumerator and one row of the table; its function, with a test, in a file of
/// sim/start/ (start_lattice.cpp, start_random.cpp and start_files.cpp hold the present ones), and its case
/// in selected_start() of sim/start/start.cpp. `twincell keys scene` prints its line of help.

#include <array>
#include <string_view>

#include "core/choice.hpp"

namespace twincell::sim {

/// Initial positions of the beads.
enum class StartKind { crystal_a, crystal_b, random, trajectory, table };

/// A kind of start and what it needs from the scene.
struct StartRow {
  StartKind value;
  std::string_view word;  ///< start.kind
  std::string_view help;
  bool from_file = false;   ///< the beads are those of start.from; start.in_motion can keep their motion
  bool has_frames = false;  ///< the file has several frames; start.frame selects one
  /// Positions are drawn with start.seed, and velocities with start.velocity_scale, in a column of
  /// start.fraction or start.height.
  bool draws = false;
  bool sets_radii = false;  ///< the file sets the radii, so that beads.spread cannot
};

/// All kinds of start. The first is the default.
inline constexpr std::array kStarts = {
    StartRow{.value = StartKind::crystal_a,
             .word = "crystal_a",
             .help = "close-packed rows (3D: layers of the hexagonal stack) parallel to the plate"},
    StartRow{.value = StartKind::crystal_b,
             .word = "crystal_b",
             .help = "close-packed rows (3D: layers of the hexagonal stack) parallel to the side walls"},
    StartRow{.value = StartKind::random,
             .word = "random",
             .help = "random positions and velocities, from which the beads fall",
             .draws = true},
    StartRow{.value = StartKind::trajectory,
             .word = "trajectory",
             .help = "a frame of a trajectory file",
             .from_file = true,
             .has_frames = true},
    StartRow{.value = StartKind::table,
             .word = "table",
             .help = "the beads of a CSV file",
             .from_file = true,
             .sets_radii = true}};

/// Largest share of the column (area, 3D: volume) of a random start. Random placement becomes slow near its
/// limit, 0.547 in 2D and 0.38 in 3D.
constexpr double largest_fraction(int dimension) {
  return dimension == 2 ? 0.5 : 0.35;
}

/// The row of a kind of start.
constexpr const StartRow& start_row(StartKind kind) {
  return row_of(kStarts, kind);
}

}  // namespace twincell::sim
