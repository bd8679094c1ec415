#pragma once
/// \file
/// Phases of the bed and the thresholds of s_b and s_c that separate them (Fortini & Huang 2015, app. B).

#include <array>
#include <string>

#include "core/choice.hpp"

namespace twincell::analysis {

/// Half a pixel of paper 1's camera, sigma: a displacement below it counts as none.
inline constexpr double kHalfPixelOfPaper1 = 1.0 / 30;
/// Threshold of s_b above which the bed leaves the plate, sigma.
inline constexpr double kBouncingThreshold = kHalfPixelOfPaper1;
/// Threshold of s_c above which the bed convects, sigma.
inline constexpr double kConvectionThreshold = 1;

/// Phases of the bed.
enum class BedPhase { undetermined, co_moving, bouncing, convecting };
/// All phases with their words.
inline constexpr std::array kBedPhases = {
    Choice<BedPhase>{BedPhase::undetermined, "undetermined", "the measurement does not decide"},
    Choice<BedPhase>{BedPhase::co_moving, "co-moving", "the bed stays on the plate: s_b <= sigma/30"},
    Choice<BedPhase>{
        BedPhase::bouncing, "bouncing",
        "the bed leaves the plate, its beads keep their neighbours: s_b > sigma/30, s_c <= sigma"},
    Choice<BedPhase>{BedPhase::convecting, "convecting",
                     "the bed leaves the plate and convects: s_b > sigma/30, s_c > sigma"}};
/// The word of a phase.
std::string phase_name(BedPhase phase);
/// What begins with a phase, as in "onset of bouncing" and "onset of convection".
std::string onset_name(BedPhase phase);
/// Inverse of phase_name; undetermined for any other text.
BedPhase phase_named(const std::string& name);

/// Phase of a bed. co-moving: s_b <= sigma/30; bouncing: s_b > sigma/30 and s_c <= sigma; convecting: both
/// above. NaN represents a missing number; the phase is undetermined if it depends on that number.
BedPhase bed_phase(double s_b, double s_c);

}  // namespace twincell::analysis
