#pragma once
/// \file
/// Where beads begin: lattices, random deposits, any frame of any trajectory.

#include <cstdint>
#include <vector>

#include "analysis/trajectory/trajectory.hpp"
#include "sim/scene.hpp"
#include "sim/state.hpp"

namespace twincell::sim {

/// Beads before they settle; z = 0 is the plate.
struct Start {
  std::vector<Bead> beads;
  std::vector<std::uint8_t> tracer;  ///< carried over from a trajectory; empty otherwise
};

/// Close-packed rows parallel to the plate, alternately floor(width) and one fewer beads, touching, first row
/// on the plate. The last row fills from the left.
Start crystal_a(const Scene& scene);
/// Close-packed rows parallel to the side walls, filled from below, then from the left.
Start crystal_b(const Scene& scene);
/// Beads at random places without overlap in a tall column, with random velocities; they still have to fall.
Start random_deposit(const Scene& scene);
/// Frame `scene.frame` of `scene.from`: heights against the plate, empty slots left out, small overlaps
/// pushed apart. \throws InputError for a missing frame or bead outside the cell; ConfigError for overlaps
/// beyond 0.05 sigma
Start from_trajectory(const Scene& scene);
/// Whichever the scene asks for.
Start make_start(const Scene& scene);

/// Pushes overlapping beads apart by at most 0.01 sigma a sweep until no overlap exceeds `tolerance`. Never
/// by integrating the contact force, which would launch them. Returns the largest overlap left.
double relax_overlaps(std::vector<Bead>& beads, double width, bool periodic, double tolerance,
                      int max_sweeps);

/// Refuses, naming beads: positions or velocities that are not finite, overlaps beyond `bound`, beads outside
/// the cell.
void require_sound(const std::vector<Bead>& beads, const Scene& scene, double bound);

/// Tracers at the middle of the resting bed (app. B: "at the centre, in a straight horizontal line"): of a
/// crystal the lattice row nearest to half height, otherwise the bead nearest to half height in every column
/// one diameter wide.
std::vector<std::uint8_t> choose_tracers(const std::vector<Bead>& resting, const Scene& scene);

}  // namespace twincell::sim
