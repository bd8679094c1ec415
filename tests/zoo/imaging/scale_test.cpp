// Cells that state the scale of their beads and nothing else about them.
#include <gtest/gtest.h>

#include <optional>
#include <string>

#include "imaging/settings/check_scale.hpp"
#include "tests/support/complaint.hpp"
#include "tests/support/one_picture.hpp"
#include "tests/zoo/imaging/kinds.hpp"

namespace twincell::zoo::scale_test {
namespace {

/// The refiner for a picture whose cell states `diameter` px per sigma.
std::optional<std::string> refiner_of(const Exhibit& exhibit, double diameter, bool polarity_open = true,
                                      bool refiner_open = true) {
  imaging::OnePicture stack(exhibit.picture);
  imaging::FramesAhead ahead(stack);
  imaging::LocatorOptions given;
  given.diameter_px = diameter;
  given.diameter_of_scale = true;
  return check_beads_at_scale(ahead, given,
                              {.file = "CELL.toml",
                               .key = "camera.pixels_per_sigma",
                               .polarity_open = polarity_open,
                               .refiner_open = refiner_open},
                              1);
}

// Before, the default refiner found 15 of 168 glass beads of a film whose cell stated the scale alone.
TEST(CellsOfAScale, FindTheRefinerOfTheirBeads) {
  constexpr double kDiameter = 20;
  EXPECT_EQ(refiner_of(opaque(kDiameter), kDiameter), std::nullopt);
  EXPECT_EQ(refiner_of(clear(kDiameter), kDiameter), "profile");
  EXPECT_EQ(refiner_of(clear(kDiameter), kDiameter, true, false), std::nullopt) << "a stated refiner stands";
}

TEST(CellsOfAScale, RefuseAnotherPolarityAndAnotherSize) {
  constexpr double kDiameter = 20;
  expect_refusal<ConfigError>([] { (void)refiner_of(fluorescent(kDiameter), kDiameter); },
                              "CELL.toml: camera.bright", "brighter than their surroundings");
  EXPECT_EQ(refiner_of(fluorescent(kDiameter), kDiameter, false, false), std::nullopt)
      << "a stated polarity stands";
  expect_refusal<ConfigError>([] { (void)refiner_of(opaque(kDiameter), 0.7 * kDiameter); },
                              "camera.pixels_per_sigma: is 14", "px wide");
}

}  // namespace
}  // namespace twincell::zoo::scale_test
