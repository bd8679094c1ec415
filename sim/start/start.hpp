#pragma once
/// \file
/// Where beads begin: lattices, random deposits, tables, any frame of any trajectory.

#include <cstdint>
#include <vector>

#include "core/progress.hpp"
#include "sim/scene/scene.hpp"
#include "sim/system/system.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sim {

/// Beads before they settle; z = 0 is the plate. An intruder is the last of them.
struct Start {
  std::vector<Bead> beads;
  std::vector<std::uint8_t> tracer;  ///< carried over from a trajectory; empty otherwise
  // Of a trajectory start in motion whose frame holds them; empty otherwise.
  std::vector<ContactMemory> contacts = {};
  std::vector<Force> forces = {};
  std::vector<Vec3> rim_speeds = {};
  std::optional<double> phase =
      {};  ///< of the drive, cycles: that of the frame a start in motion goes on from
};

/// Radii of the scene's beads, drawn from its seed; all the same without a spread.
std::vector<double> draw_radii(const Scene& scene, std::size_t n);

/// Whether another start.seed makes another run: places of a random start, radii with a spread, perturbation.
/// A table brings its own radii. True for a spread on a trajectory start, whose file may bring its own too.
bool has_chance(const Scene& scene);

/// Close-packed layers parallel to the plate, filled from below.
///
/// 2D, and 3D cells too shallow for a second row (depth < d (1 + 1/sqrt 12)), in the middle of their gap:
/// rows along x, alternately floor(width) and one fewer beads, touching, sqrt(3)/2 d apart; the last row
/// fills from the left. 3D: hexagonal close packing, such layers sqrt(2/3) d apart, stacked ABAB. The lattice
/// constant d is the largest bead's diameter. Sites inside an intruder, a wall or beyond the lid stay empty.
/// \throws ConfigError if the cell holds fewer beads than the scene asks for
Start crystal_a(const Scene& scene, Progress& progress = Progress::none());
/// The same lattices turned by 90 degrees: close-packed rows vertical. 2D: rows parallel to the side walls.
/// 3D: the close-packed layers of the hexagonal stack are parallel to the side walls. Filled from below, then
/// from the left.
Start crystal_b(const Scene& scene, Progress& progress = Progress::none());
/// Beads at random places without overlap in a tall column, large ones first, with random velocities; they
/// still have to fall. Without gravity they fill the cell. \throws ConfigError if they find no places
Start random_deposit(const Scene& scene, Progress& progress = Progress::none());
/// Frame `scene.frame` of `scene.from`: positions against the plate, empty slots left out, velocities
/// forgotten. With scene.in_motion everything is kept as it is: positions, velocities, spins, the phase of
/// the drive, and what contacts remember if the frame holds it. Radii and masses are the file's if a
/// simulation wrote it, otherwise the scene's: a camera's radii are measurements. A 2D trajectory in a 3D
/// cell lies in the middle of its gap. What a camera's noise makes overlap by up to 0.2 of the smaller
/// diameter is pushed apart until no overlap exceeds 1e-4. \throws InputError if the file cannot be read;
/// ConfigError for a missing frame, beads outside the cell or deeper in each other than 0.2, overlaps beyond
/// 0.05 that remain
Start from_trajectory(const Scene& scene, Progress& progress = Progress::none());
/// A CSV table: a line that names the columns (x, z; optional y, vx, vy, vz, spin, spin_x, spin_z, radius,
/// mass), then one bead a line. A missing radius is the scene's, a missing mass that of the same material, a
/// missing y the middle of the gap, anything else 0. \throws InputError naming file, line and column of a bad
/// number; ConfigError if beads.count says otherwise
Start from_table(const Scene& scene, Progress& progress = Progress::none());
/// Whichever the scene asks for, its overlaps pushed apart and perturbed as it asks. \throws ConfigError also
/// for overlaps that cannot be pushed apart \param progress asked many times a second; it may throw
/// Interrupted
Start make_start(const Scene& scene, Progress& progress = Progress::none());

/// Pushes overlapping beads apart, and out of walls, by at most 0.01 sigma a contact and sweep until no
/// overlap exceeds `tolerance`; the lighter bead gives way. Never by integrating the contact force, which
/// would launch them. Returns the largest overlap left.
double relax_overlaps(std::vector<Bead>& beads, const Scene& scene, double tolerance, int max_sweeps,
                      Progress& progress = Progress::none());

/// Refuses, naming beads: positions or velocities that are not finite, beads too large for a period, beads in
/// each other or in walls deeper than `bound` of the smaller one's diameter. \param plate where the
/// walls that ride with it are, against its mean
void require_sound(const std::vector<Bead>& beads, const Scene& scene, double bound,
                   Progress& progress = Progress::none(), const Vec3& plate = Vec3::Zero());

/// Tracers at the middle of the resting bed (app. B: "at the centre, in a straight horizontal line"): of
/// crystal A the lattice layer nearest to half height, otherwise the bead nearest to half height in every
/// column one diameter wide (and, in 3D, deep). An intruder is none.
std::vector<std::uint8_t> choose_tracers(const std::vector<Bead>& resting, const Scene& scene);

}  // namespace twincell::sim
