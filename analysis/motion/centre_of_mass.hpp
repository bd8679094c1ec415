#pragma once
/// \file
/// Height of the centre of mass.

#include <memory>
#include <optional>
#include <string>

#include "analysis/observable/observable.hpp"
#include "trajectory/centre_of_mass.hpp"

namespace twincell {

/// Kinetic energy per bead, m g sigma, up to which a bed counts as resting: it is by no more than that, in
/// sigma, that the centre of mass may still sink or rise. Smooth beds never come to rest altogether, for a
/// bead may glide on them for ever, nor do those of a law without static friction.
inline constexpr double kAtRest = 0.005;

/// Height of the centre of mass above the plate, sigma, if the bed rests in this frame: beads known by their
/// velocities to move with the plate, or not at all before the drive begins (time 0), up to kAtRest.
/// \param why_not why there is none, if so
std::optional<double> resting_height(const TrajectoryInfo& info, const Frame& frame, std::string& why_not);

/// Results h_cm (mean over whole cycles, or over frames without phases), h_cm_k (mean in each phase), h_cm_j
/// (mean of each whole cycle), delta_h_cm = h_cm - AnalysisContext::rest_height (absent without it: a rest
/// height is measured and never assumed) and delta_h_bar = delta_h_cm g/V_p^2. Bhateja, Sharma & Singh 2016,
/// Table II and Fig. 7.
std::unique_ptr<Observable> make_centre_of_mass(const AnalysisContext& context);

}  // namespace twincell
