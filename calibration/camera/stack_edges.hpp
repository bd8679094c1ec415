#pragma once
/// \file
/// The edges of the cell in the frames of a stack, as fit_cell_geometry() takes them.

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <optional>
#include <vector>

#include "core/progress.hpp"
#include "imaging/cell/cell_edges.hpp"
#include "imaging/stack/chosen_frames.hpp"
#include "imaging/stack/frame_source.hpp"

namespace twincell::calibration {

/// Edges of a whole stack: the plate in every frame, the walls in about forty frames.
struct StackEdges {
  cv::Size size;
  std::vector<std::vector<imaging::EdgePoint>> plate;        ///< [frames]
  std::vector<std::vector<imaging::EdgePoint>> left, right;  ///< [frames 0, stride, 2 stride ...]
  std::size_t stride = 1;
  std::vector<std::uint8_t> repeats;  ///< [frames] as imaging::RepeatedFrames::repeats
  std::vector<double> time_s;         ///< camera time stamp of each frame; empty if the stack has none
  double blur_px = 0;                 ///< median over frames
  double diameter_px = 15;            ///< bead diameter: the correlation length of errors along an edge
};
/// Bead diameter for the edge detection, px: the known one, else an estimate from the first frame, else 15
/// px.
double diameter_for_edges(const std::filesystem::path& stack, bool bright, double known_px);
/// Frames per second: as the user states them, else from the camera's time stamps, else from the stack's
/// metadata. The playback rate of a video does not count. Empty if no source gives a frame rate.
/// \param range the frames of the stack that `edges` are of; the rate is that of these frames
std::optional<double> frame_rate_of(std::optional<double> stated, const StackEdges& edges,
                                    const std::filesystem::path& stack,
                                    const imaging::FrameRange& range = {});
/// Finds the edges in every frame; reads the stack once.
/// \throws InputError as FrameSource
StackEdges read_stack_edges(imaging::FrameSource& frames, const imaging::BeadsAtEdges& beads, int threads,
                            Progress& progress = Progress::none());

}  // namespace twincell::calibration
