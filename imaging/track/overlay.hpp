#pragma once
/// \file
/// Pictures that show what was found.

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "imaging/refine/picture_fit.hpp"

namespace twincell {

/// The frame, enlarged, with a thin circle of the fitted radius and a centre dot per bead: green; orange
/// where the frame cuts the bead; magenta for tracers.
cv::Mat3b draw_overlay(const cv::Mat& grey, const std::vector<Detection>& beads, int enlarge);

/// Writes a PNG, whole or not at all.
/// \throws ConfigError if the place cannot be written to, RunError if writing fails
void write_png(const std::filesystem::path& png, const cv::Mat& picture);

/// Draws with an enlargement that suits the frame's size and writes a PNG, whole or not at all.
/// \throws ConfigError if the place cannot be written to, RunError if writing fails
void write_overlay(const std::filesystem::path& png, const cv::Mat& grey,
                   const std::vector<Detection>& beads);

}  // namespace twincell
