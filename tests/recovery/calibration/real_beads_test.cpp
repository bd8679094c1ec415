// Calibration of frames from outside the project, against published sizes and counts.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <iostream>

#include "calibration/camera/cell_geometry.hpp"
#include "calibration/camera/size_statistics.hpp"
#include "imaging/benchmark/score.hpp"
#include "imaging/stack/open_frames.hpp"

namespace twincell::real_beads_test {

using namespace calibration;

namespace {

const std::filesystem::path kImages = TWINCELL_SOURCE_DIR "/../shared/real_images";
constexpr const char* kNotThere = "The real images are not beside the source tree.";

SizeStatistics census_of(const std::filesystem::path& stack) {
  const auto frames = imaging::open_frames(stack);
  imaging::LocatorOptions locator;
  return count_beads(locate_beads(*frames, locator, std::nullopt, 20, 1));
}

}  // namespace

TEST(RealBeads, SizesMatchTruthAndNoWallIsInvented) {
  // Glass beads in a flume (Lafaye de Micheaux et al., Machine Vision and Applications 29 (2018) 735), at
  // half resolution.
  const auto folder = kImages / "bedload_left_half";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << kNotThere;
  // Radii of the black beads with the most certain reference values, from a separate fit that is accurate to
  // 0.05 px.
  double sum = 0, squares = 0, n = 0;
  for (const auto& frame : imaging::read_truth(folder))
    for (const imaging::TruthBead& bead : frame)
      if (bead.counts && bead.u < 0.051) sum += 2 * bead.r, squares += 4 * bead.r * bead.r, ++n;
  const double mean = sum / n, spread = std::sqrt(squares / n - mean * mean) / mean;
  const SizeStatistics c = census_of(folder);
  std::cout << "diameter " << c.diameter.value << " +- " << c.diameter.error << " px, truth " << mean
            << "; spread " << c.spread.value << " +- " << c.spread.error << ", truth " << spread << "\n";
  EXPECT_NEAR(c.diameter.value, mean, 0.1);
  EXPECT_NEAR(c.spread.value, spread, 3 * c.spread.error);
  // The flume is wider than the image: the rims of beads cut by the border are not side walls.
  const auto frames = imaging::open_frames(folder);
  const CellGeometry g = fit_cell_geometry(read_stack_edges(*frames, {.diameter_px = mean}, 1));
  EXPECT_FALSE(g.has_left || g.has_right);
}

TEST(RealBeads, AllPucksAreCounted) {
  const auto folder = kImages / "pucks_22";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << kNotThere;
  const SizeStatistics c = census_of(folder);
  std::cout << c.count.value << " pucks of " << c.diameter.value << " +- " << c.diameter.error << " px\n";
  EXPECT_EQ(c.count.value, 22);            // the count in the name of the film
  EXPECT_NEAR(c.diameter.value, 45, 1.5);  // "about 45 px"
}

}  // namespace twincell::real_beads_test
