#pragma once
/// \file
/// Overlays: pictures that show the located beads.

#include <filesystem>
#include <opencv2/core.hpp>
#include <vector>

#include "imaging/refine/picture_fit.hpp"

namespace twincell::imaging {

/// The enlarged frame with a thin circle of the fitted radius and a centre dot for each bead: green, orange
/// if the frame cuts the bead, magenta for tracers.
cv::Mat3b draw_overlay(const cv::Mat& grey, const std::vector<Detection>& beads, int enlarge);

/// Writes a PNG atomically (complete or not at all).
/// \throws ConfigError if the path is not writable, RunError if writing fails
void write_png(const std::filesystem::path& png, const cv::Mat& picture);

/// Draws the overlay with an enlargement that suits the frame's size and writes it as a PNG, complete or not
/// at all.
/// \throws ConfigError if the path is not writable, RunError if writing fails
void write_overlay(const std::filesystem::path& png, const cv::Mat& grey,
                   const std::vector<Detection>& beads);

}  // namespace twincell::imaging
