#pragma once
/// \file
/// Debug pictures: input and result of each stage of the locator.

#include <filesystem>
#include <opencv2/core.hpp>

#include "core/output_kind.hpp"
#include "imaging/locate/locator.hpp"

namespace twincell::imaging {

/// The output kind of the folder of pictures.
inline Product debug_folder() {
  return Product::whole_folder("pictures of the locator's stages");
}

/// Writes a folder with these files:
///
/// - 1_darkness.png: the darkness; walls are tinted
/// - 2_proposals.png: the proposed discs
/// - 3_model.png: all fitted discs, in the same shades
/// - 4_residual.png: darkness less model; grey is zero, black and white are -0.2 and 0.2
/// - 5_judged.png: beads green, beads cut by the frame orange, tracers magenta; dropped candidates red with
///   the number of their verdict
/// - candidates.csv: every candidate, its numbers and its verdict
///
/// Requires diameter_px > 0.
/// \throws ConfigError if the folder cannot be written to
void write_debug_pictures(const std::filesystem::path& folder, const cv::Mat& grey,
                          const LocatorOptions& options);

}  // namespace twincell::imaging
