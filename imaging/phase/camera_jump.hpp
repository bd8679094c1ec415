#pragma once
/// \file
/// A camera, or a cell, that is bumped during a film: from one frame to the next, all that the picture shows
/// is shifted, and stays so.
///
/// Two signs show it without links or phases. Sideways: all beads between the side walls shift together,
/// whereas in any other frame some move to either side. Upwards: the height of the plate departs from its
/// sine by a step.

#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace twincell::imaging {

/// A shift of the picture that begins with a frame, px; to the right and downwards.
struct CameraJump {
  std::size_t frame = 0;
  std::optional<double> right_px, down_px;  ///< absent: no jump in this direction was seen
};

/// The nine deciles of the positions of the beads in a frame, all that a frame leaves in memory.
using Deciles = std::array<double, 9>;
/// Empty for fewer than 20 beads.
std::optional<Deciles> deciles_of(std::vector<double> x_px);

/// The jumps of the beads to one side. In a jump all deciles of the positions move together, by more than
/// four times what they do between nearly all other frames, and by at least a tenth of a bead; and they do
/// not return within three frames.
/// \param x_px [frames]; a frame without deciles is left out
std::vector<CameraJump> jumps_of_beads(std::span<const std::optional<Deciles>> x_px, double diameter_px);

/// The jump of a plate that follows a sine: the step that explains what a sine and its second harmonic leave
/// of its height, to a quarter of the step. Empty: there is none, or the plate is not seen.
/// \param plate_px [frames] LockEvidence::plate_px
/// \param frames_per_cycle 0: not known, then there is no jump
std::optional<CameraJump> jump_of_plate(std::span<const double> plate_px, int frames_per_cycle);

/// Both, in the order of the frames; jumps of neighbouring frames are one.
std::vector<CameraJump> merged(std::vector<CameraJump> beads, const std::optional<CameraJump>& plate);

/// The jumps as a sentence without a full stop, with what to do. Empty if there are none.
std::string in_words(std::span<const CameraJump> jumps, std::size_t frames);

}  // namespace twincell::imaging
