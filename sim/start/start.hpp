#pragma once
/// \file
/// Initial positions of the beads: lattices, random deposits, tables, or a frame of a trajectory.

#include <cstdint>
#include <vector>

#include "core/error.hpp"
#include "core/progress.hpp"
#include "sim/scene/scene.hpp"
#include "sim/system/system.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sim {

/// Beads before they settle; z = 0 is the plate. An intruder is the last bead.
struct Start {
  std::vector<Bead> beads;
  std::vector<std::uint8_t> tracer;  ///< carried over from a trajectory; empty otherwise
  // From the frame of a trajectory that starts in motion, if it contains them; otherwise empty.
  std::vector<ContactMemory> contacts = {};
  std::vector<Force> forces = {};
  std::vector<Vec3> rim_speeds = {};
  /// Drive phase of the frame from which a start in motion continues, in cycles.
  std::optional<double> phase = {};
};

/// A start has no room for its beads. Another seed, or another cell, may have it.
class NoRoom : public ConfigError {
 public:
  using ConfigError::ConfigError;
};

/// Radii of n beads, sigma, drawn with the seed of the scene; without a size spread all are equal.
std::vector<double> draw_radii(const Scene& scene, std::size_t n);

/// Whether another start.seed gives another run: random positions, radii with a spread, or a perturbation. A
/// table sets its own radii. True for a spread with a trajectory start, although the file may set its own
/// radii too.
bool has_chance(const Scene& scene);

/// Close-packed layers parallel to the plate, filled from below.
///
/// 2D, and 3D cells too shallow for a second row (depth < d (1 + 1/sqrt 12)), in the middle of their gap:
/// rows along x of touching beads, alternately floor(width) and one fewer, sqrt(3)/2 d apart; the last row
/// fills from the left. 3D: hexagonal close packing, layers of such rows sqrt(2/3) d apart, stacked ABAB. The
/// lattice constant d is the diameter of the largest bead. Sites inside an intruder or a wall, or beyond the
/// lid, stay empty.
/// \throws ConfigError if the cell has room for fewer beads than the scene requires
Start crystal_a(const Scene& scene, Progress& progress = Progress::none());
/// The same lattices rotated by 90 degrees: close-packed rows are vertical. 2D: rows parallel to the side
/// walls. 3D: the close-packed layers of the hexagonal stack are parallel to the side walls. Filled from
/// below, then from the left.
Start crystal_b(const Scene& scene, Progress& progress = Progress::none());
/// Beads at random positions without overlap in a tall column, large ones placed first, with random
/// velocities; they fall during settling. Without gravity they fill the cell.
/// \throws ConfigError if too few free positions are found
Start random_deposit(const Scene& scene, Progress& progress = Progress::none());
/// Why the walls of a scene that begins at `phase` of its drive would not be where they are in a frame;
/// begins with " has". Empty if they are, or if the file does not state it. The file's own scene states which
/// of its walls moved; without it, those that move here. A bed in contact with a wall that jumps is thrown
/// off.
std::string displaced_wall(const Scene& scene, const TrajectoryInfo& info, const Frame& frame, double phase);

/// Frame `scene.frame` of `scene.from`: positions relative to the plate, without empty slots, velocities set
/// to 0. With scene.in_motion everything is kept: positions, velocities, spins, the phase of the drive, and
/// the contact memories if the frame contains them.
///
/// Radii and masses are those of the file if a simulation wrote it, otherwise those of the scene, because
/// radii from a camera are measurements. A 2D trajectory in a 3D cell is placed in the middle of the gap.
/// Camera noise can make beads overlap: overlaps of up to 0.2 of the smaller diameter are pushed apart until
/// none exceeds 1e-4.
/// \throws InputError if the file cannot be read; ConfigError for a missing frame, beads outside the cell,
/// overlaps deeper than 0.2, or remaining overlaps above 0.05
Start from_trajectory(const Scene& scene, Progress& progress = Progress::none());
/// A CSV table: a header line that names the columns (x, z; optional y, vx, vy, vz, spin, spin_x, spin_z,
/// radius, mass), then one bead per line. Defaults for missing columns: the radius of the scene, the mass of
/// a bead of the same material, for y the middle of the gap, otherwise 0.
/// \throws InputError naming file, line and column of an invalid number; ConfigError if beads.count differs
Start from_table(const Scene& scene, Progress& progress = Progress::none());
/// The start that the scene selects, with overlaps pushed apart and perturbed if the scene requires it.
/// \throws ConfigError also for overlaps that cannot be pushed apart
/// \param progress called many times per second; it may throw Interrupted
Start make_start(const Scene& scene, Progress& progress = Progress::none());

/// Pushes overlapping beads apart, and out of walls, by at most 0.01 sigma per contact and sweep until no
/// overlap exceeds `tolerance`. The displacements are in inverse proportion to the masses. The contact force
/// is not integrated, because it would launch the beads.
/// \returns the largest remaining overlap
double relax_overlaps(std::vector<Bead>& beads, const Scene& scene, double tolerance, int max_sweeps,
                      Progress& progress = Progress::none());

/// Refuses a start, naming the beads, if positions or velocities are not finite, if beads are too large for a
/// period, or if beads overlap each other or walls by more than `bound` times the smaller diameter.
/// \param plate displacement of the walls that move with the plate, relative to their mean position
void require_sound(const std::vector<Bead>& beads, const Scene& scene, double bound,
                   Progress& progress = Progress::none(), const Vec3& plate = Vec3::Zero());

/// Tracers in the middle of the resting bed (app. B: "at the centre, in a straight horizontal line"). In
/// crystal A they are the lattice layer nearest to half height; otherwise they are the bead nearest to half
/// height in every column one diameter wide (and, in 3D, deep). An intruder is never a tracer.
std::vector<std::uint8_t> choose_tracers(const std::vector<Bead>& resting, const Scene& scene);

}  // namespace twincell::sim
