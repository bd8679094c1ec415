#pragma once
/// \file
/// The kernel of dilute gases: beads fly from contact to contact, and only contacts are integrated.

#include <functional>
#include <memory>
#include <string>

#include "sim/kernel.hpp"
#include "sim/scene.hpp"

namespace twincell::sim {

/// Why a plan's beads cannot fly from event to event; empty if they can.
std::string why_not_flights(const Scene& scene, const Plan& plan);

/// Makes kernels that move beads by steps, of the same plan, with the same bits.
struct StepKernels {
  std::function<std::unique_ptr<Kernel>()> all, few;  ///< few: for those that meet in threes
};

/// Flights, and steps where beads meet in threes.
///
/// Beads that touch nothing fly on parabolas, exactly; the moment of the next touch is the root of a
/// quadratic (two beads, which fall alike) or of a parabola less a sine (bead and wall). A contact of two
/// bodies is integrated to a relative 1e-7 (encounter.hpp), whatever the time step. When a third body comes
/// near one that is in contact, they are moved by steps by themselves, from the whole step before until they
/// have parted (huddle.hpp). Where more than eight meet, or some stay together, all beads are handed to
/// steps, and taken back when each has at most one contact. So no contact is missed, none is simplified, and
/// the time step acts only where three bodies meet.
std::unique_ptr<Kernel> make_flight_kernel(const Plan& plan, const GuardLimits& limits, StepKernels steps);

}  // namespace twincell::sim
