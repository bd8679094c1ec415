#pragma once
/// \file
/// The page of `draw -o page.html`: a trajectory that plays in a browser.

#include <cstddef>
#include <string>

#include "core/output_kind.hpp"
#include "core/progress.hpp"
#include "imaging/drawing/drawing.hpp"

namespace twincell::cli {

/// The kind of output of the page.
inline Product draw_page() {
  return Product::text("a page of draw", "<!DOCTYPE html>\n<!-- twincell draw -->\n");
}

/// Largest size of the numbers in a page, bytes of its text. A bead takes 16/3 bytes of it in a frame in 2D,
/// 8 in 3D, as many more with its velocity, and 8/3 more with a number; a contact takes 40/3 in 2D, 16 in 3D.
inline constexpr double kLargestPage = 32e6;

/// A page and what it shows.
struct DrawnPage {
  std::string html;  ///< refers to no other file
  std::size_t frames = 0;
  std::array<double, 2> range = {0, 0};  ///< of the colours
};

/// Makes the page of the chosen frames. Positions are rounded to 1/65534 of their range in the page, numbers
/// likewise. Of the job, all but `output` and `pixels_per_sigma` is used.
/// \param trajectory the file, whose name is the title
/// \throws ConfigError for frames or columns that the trajectory lacks, for a job that asks for a scale, or
/// if the page would be larger than kLargestPage
DrawnPage page_of(const TrajectorySource& source, const imaging::DrawJob& job, const std::string& trajectory,
                  Progress& progress);

}  // namespace twincell::cli
