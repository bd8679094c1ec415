#pragma once
/// \file
/// What each stage of the locator saw and made, as pictures.

#include <filesystem>
#include <opencv2/core.hpp>

#include "core/output_kind.hpp"
#include "imaging/locate/locator.hpp"

namespace twincell {

/// The kind of output that the folder of pictures is.
inline Product debug_folder() {
  return Product::whole_folder("pictures of the locator's stages");
}

/// Writes a folder: 1_darkness.png (walls tinted), 2_proposals.png, 3_model.png (all
/// fitted discs, in the same shades), 4_residual.png (darkness less model, grey is zero, black and white are
/// -0.2 and 0.2), 5_judged.png (beads green, edge orange, tracers magenta; dropped candidates red with their
/// verdict's number), and candidates.csv (every candidate, its numbers, its verdict). Needs diameter_px > 0.
/// \throws ConfigError if the folder cannot be written to
void write_debug_pictures(const std::filesystem::path& folder, const cv::Mat& grey,
                          const LocatorOptions& options);

}  // namespace twincell
