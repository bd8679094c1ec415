#pragma once
/// \file
/// Phases of a film in which frames are repeated to the bit (stack/repeated_frames.hpp): they are determined
/// without the repetitions, which then take the phases of the frames before them.

#include <cstdint>
#include <span>

#include "imaging/phase/lock_check.hpp"

namespace twincell::imaging {

/// The evidence of the frames that repeat no other.
/// \param evidence LockEvidence::repeats is as long as the film, or empty
LockEvidence without_repeats(const LockEvidence& evidence);

/// The phases of all frames: a repeated one has the phase of the frame before it and interval 0, and counts
/// as doubled.
/// \param each the phases of the frames that repeat no other
PhaseTable with_repeats(const PhaseTable& each, std::span<const std::uint8_t> repeats);

}  // namespace twincell::imaging
