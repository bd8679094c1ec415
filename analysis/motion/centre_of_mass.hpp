#pragma once
/// \file
/// Height of the centre of mass.

#include <optional>
#include <string>

#include "analysis/observable/observable.hpp"
#include "trajectory/centre_of_mass.hpp"

namespace twincell::analysis {

/// Maximum kinetic energy per bead of a bed at rest, m g sigma. The centre of mass can then still rise or
/// sink by at most this number, in sigma. The limit is not 0, because smooth beds, on which a bead may glide
/// for ever, and beds of a law without static friction never come to rest completely.
inline constexpr double kAtRest = 0.005;

/// Why the bed does not lie at rest in this frame, which is the first of a file; empty if it does, or if
/// nothing in the file shows that it does not. It does not if the file begins after the drive, at Gamma > 1,
/// or if the kinetic energy per bead relative to the plate, or at time 0 (before the drive begins) relative
/// to the lab, exceeds kAtRest.
std::string why_not_at_rest(const TrajectoryInfo& info, const Frame& frame);

/// Height of the centre of mass above the plate, sigma, if the bed rests in this frame and velocities show
/// it.
/// \param why_not set to the reason if the result is absent
std::optional<double> resting_height(const TrajectoryInfo& info, const Frame& frame, std::string& why_not);

/// Height of the centre of mass above the mean height of the plate. Results:
///
/// - h_cm: scalar, mean over whole cycles, or over frames if they have no phase, sigma
/// - h_cm_k: [N_k] mean at each phase, sigma
/// - h_cm_j: [cycles] mean of each whole cycle, sigma
/// - delta_h_cm: scalar, h_cm - AnalysisContext::rest_height, sigma. Absent without a rest height, which is
///   measured and never assumed
/// - delta_h_bar: scalar, delta_h_cm g/V_p^2
///
/// Bhateja, Sharma & Singh 2016, Table II and Fig. 7.
extern const ObservableEntry centre_of_mass_observable;

}  // namespace twincell::analysis
