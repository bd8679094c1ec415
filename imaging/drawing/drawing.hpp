#pragma once
/// \file
/// Draws a trajectory: beads coloured by a number, the cell, tracks, velocities and contact forces.

#include <array>
#include <cstddef>
#include <filesystem>
#include <functional>
#include <opencv2/core.hpp>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "imaging/drawing/view.hpp"
#include "imaging/stack/chosen_frames.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::imaging {

/// The number that the colour of a bead shows.
struct BeadColours {
  std::string name, unit;
  /// [n_beads] of frame `index`; NaN: unknown, drawn grey. Empty function: all beads have one colour.
  std::function<std::vector<double>(std::size_t index, const Frame& frame)> of;
  /// Numbers at the ends of the colour map; absent: the smallest and the largest of the drawn frames.
  std::optional<std::array<double, 2>> range;
};

/// Options of a drawing.
struct DrawJob {
  std::filesystem::path output;  ///< .png: the last of the chosen frames; .mp4, .avi: all of them
  FrameRange frames;
  BeadColours colours;
  std::size_t tracks = 0;       ///< number of earlier frames over which each bead's path is drawn
  bool vectors = false;         ///< velocities as arrows, the longest 2 sigma long
  bool contacts = false;        ///< contacts as lines whose width is proportional to the normal force
  double pixels_per_sigma = 0;  ///< 0: fitted
  double frames_per_second = 25;

  [[nodiscard]] bool film() const { return output.extension() != ".png"; }
};

/// Result of a drawing.
struct Drawn {
  std::size_t frames = 0;
  std::array<double, 2> range = {0, 0};  ///< of the colours
  cv::Size size;                         ///< px
};

/// Colour of `value` in the map viridis between the ends of `range`, BGR; grey for NaN.
cv::Vec3b map_colour(double value, const std::array<double, 2>& range);

/// Numbers of the chosen frames, in order.
/// \throws ConfigError if the trajectory lacks them
std::vector<std::size_t> indices_of(const TrajectorySource& source, const FrameRange& range);

/// Cycle, phase and Gamma of a frame, or its time, as a title.
std::string frame_title(const Frame& frame, const TrajectoryInfo& info);

/// Displacement of the cell in a frame along x and y, and the height of its plate, sigma. A cell that is
/// periodic along x does not move along it.
Vec3 cell_displacement(const Frame& frame, const TrajectoryInfo& info);

/// Projection of the chosen frames: from the lowest plate to one sigma above the highest bead.
View view_of(const TrajectorySource& source, const DrawJob& job);

/// \throws ConfigError for vectors or contacts that the trajectory lacks, and for a range of colours without
/// a number, or whose ends are not two increasing numbers
void require_drawable(const TrajectorySource& source, const DrawJob& job);

/// Longest arrow and widest line of a drawing, sigma.
inline constexpr double kLongestArrow = 2, kWidestLine = 0.4;

/// Draws the frames and writes the picture or the film, complete or not at all.
/// \throws ConfigError for another extension, frames that the trajectory lacks, or data that it lacks;
/// RunError if the output cannot be written
Drawn draw(const TrajectorySource& source, const DrawJob& job, Progress& progress = Progress::none());

}  // namespace twincell::imaging
