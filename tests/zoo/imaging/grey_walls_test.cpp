// Black beads in a cell whose walls and plate are grey, as aluminium in back light: even grey is not tiled
// with discs, and beads are not called tracers because of it.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <opencv2/imgproc.hpp>
#include <string>
#include <utility>
#include <vector>

#include "imaging/benchmark/score.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/refine/rim_aspect.hpp"
#include "imaging/settings/auto_configuration.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/settings/settings_choice.hpp"
#include "imaging/settings/settings_doubts.hpp"
#include "tests/support/one_picture.hpp"
#include "tests/zoo/imaging/kinds.hpp"

namespace twincell::zoo::grey_walls_test {
namespace {

/// A bed on a plate between two walls, all as wide as two beads and of one share of the light.
Exhibit grey_cell(double d, double share, double filled, std::uint64_t seed) {
  const int side = 320;
  const double wall = 2.2 * d;
  Painter canvas(side, kLight);
  canvas.everywhere([&](double x, double y, double below) {
    return x < wall || x > side - 1 - wall || y > side - 1 - wall ? share * kLight : below;
  });
  const Places places =
      at_rest(d, {wall + 0.6 * d, 0.7 * d, side - 2 * wall - 1.2 * d, side - wall - 1.4 * d}, filled, seed);
  for (const Place& p : places)
    canvas.disc(p.x, p.y, p.radius, [](double, double, double) { return 0.03 * kLight; });
  return {canvas.exposed(kBlur, kNoise, seed), truth_of(places)};
}

TEST(WallsOfEvenGrey, HoldNoBeads) {
  for (const double d : {9.0, 14.0, 20.0})
    for (const double share : {0.25, 0.4, 0.55})
      for (const double filled : {0.25, 0.8}) {
        if (filled > 0.5 && share != 0.4) continue;  // a dense bed is the easier case
        const Exhibit exhibit = grey_cell(d, share, filled, 3);
        imaging::LocatorOptions open;
        open.polarity_known = false;
        const auto settings = imaging::find_settings(exhibit.picture, open);
        ASSERT_TRUE(settings) << d << ' ' << share;
        std::vector<imaging::FoundBead> found;
        std::size_t tracers = 0;
        for (const imaging::Detection& b :
             imaging::locate(exhibit.picture, imaging::completed(*settings, open)).beads) {
          found.push_back({b.x, b.y, -1});
          tracers += b.tracer ? 1 : 0;
        }
        imaging::Scorer scorer;
        scorer.add(exhibit.truth, found);
        const imaging::Score score = scorer.score();
        std::printf(
            "%2g px, walls %.2f, %.2f filled: %3zu beads, %zu missed, %zu false, %zu tracers, rms %.4f px, "
            "%s\n",
            d, share, filled, exhibit.truth.size(), exhibit.truth.size() - score.found, score.false_finds,
            tracers, score.rms, settings->method.c_str());
        SCOPED_TRACE(fmt::format("{} px, walls of {} of the light, {} filled", d, share, filled));
        EXPECT_EQ(score.found, exhibit.truth.size());
        EXPECT_EQ(score.false_finds, 0U);
        EXPECT_EQ(tracers, 0U);
        EXPECT_LT(score.rms, 0.05);
      }
}

// The reflections of a ring of lamps are many times as bright as the balls that show them.
TEST(SteelBalls, AreMeasuredByTheirBodies) {
  for (const double d : {16.0, 24.0}) {
    const int side = static_cast<int>(20 * d);
    Painter canvas(side, 6);
    const Places places = at_rest(d, {0.7 * d, 0.7 * d, side - 1.4 * d, side - 1.4 * d}, 0.6, 4);
    for (const Place& p : places)
      canvas.disc(p.x, p.y, p.radius, [](double u, double v, double) {
        const double r = std::hypot(u, v);
        return r > 0.3 && r < 0.5 ? 210.0 : 40.0;
      });
    const Exhibit exhibit{canvas.exposed(kBlur, kNoise, 4), truth_of(places)};
    for (const bool stated : {false, true}) {
      imaging::LocatorOptions options;
      options.polarity_known = false;
      if (stated) options.diameter_px = d;
      const auto settings = imaging::find_settings(exhibit.picture, options);
      ASSERT_TRUE(settings) << d;
      imaging::LocatorOptions settled = imaging::completed(*settings, options);
      if (stated) settled.refine.method = "profile";
      double radius = 0;
      const auto beads = imaging::locate(exhibit.picture, settled).beads;
      for (const imaging::Detection& b : beads) radius += b.radius / static_cast<double>(beads.size());
      std::printf("%g px%s: %zu of %zu beads, diameter %.2f px, %s %.2f\n", d, stated ? ", stated" : "",
                  beads.size(), places.size(), 2 * radius, settings->method.c_str(), settings->diameter_px);
      EXPECT_NEAR(2 * radius, d, 0.02 * d) << (stated ? "stated" : "found");
      EXPECT_EQ(beads.size(), places.size());
    }
  }
}

/// Glossy beads on a dark ground, each with a highlight beside its middle.
/// \param bright of the highlight, grey levels
/// \param wide standard deviation of the highlight, radii
Exhibit glossy(double d, double bright, double wide, std::uint64_t seed) {
  const int side = static_cast<int>(16 * d);
  Painter canvas(side, 25);
  const Places places = at_rest(d, {0.7 * d, 0.7 * d, side - 1.4 * d, side - 1.4 * d}, 0.7, 4);
  for (const Place& p : places)
    canvas.disc(p.x, p.y, p.radius, [&](double u, double v, double) {
      const double u0 = u + 0.12, v0 = v + 0.25;
      return 95 + bright * std::exp(-0.5 * (u0 * u0 + v0 * v0) / (wide * wide));
    });
  return {canvas.exposed(0.85, 2.5, seed), truth_of(places)};
}

struct OfTruth {
  double radius = 0, off = 0, scatter = 0;  // px: mean radius; mean displacement, and the scatter about it
};
OfTruth compared(const std::vector<imaging::Detection>& beads, const Exhibit& exhibit) {
  cv::Point2d sum;
  double squares = 0;
  OfTruth result;
  const auto n = static_cast<double>(beads.size());
  for (const imaging::Detection& b : beads) {
    cv::Point2d nearest(1e3, 1e3);
    for (const imaging::TruthBead& t : exhibit.truth)
      if (const cv::Point2d off(b.x - t.x, b.y - t.y); cv::norm(off) < cv::norm(nearest)) nearest = off;
    sum += nearest;
    squares += nearest.dot(nearest);
    result.radius += b.radius / n;
  }
  result.off = cv::norm(sum) / n;
  result.scatter = std::sqrt(std::max(0.0, squares / n - result.off * result.off));
  return result;
}

// Before, the highlights were taken for the beads (6.0 of 13.4 px), discs of a stated diameter had radii of
// 0.3 to 1 of the stated one from frame to frame, and all centres were drawn towards the highlights, by 1.7
// px.
TEST(GlossyBeads, AreMeasuredByTheirRimsNotByTheirHighlights) {
  constexpr double kDiameter = 13.4;
  for (const auto& [bright, wide] : {std::pair{110.0, 0.3}, {140.0, 0.18}})
    for (const bool stated : {false, true}) {
      const Exhibit first = glossy(kDiameter, bright, wide, 1);
      imaging::OnePicture stack(first.picture);
      imaging::FramesAhead ahead(stack);
      imaging::LocatorOptions options;
      options.polarity_known = stated;
      options.preprocess.bright = stated;
      if (stated) options.diameter_px = kDiameter, options.refine.method = "profile";
      const imaging::LocatorOptions settled = imaging::configure_locator(ahead, options).locator;
      for (const std::uint64_t frame : {1, 2, 3}) {
        const Exhibit exhibit = glossy(kDiameter, bright, wide, frame);
        const auto beads = imaging::locate(exhibit.picture, settled).beads;
        const OfTruth of = compared(beads, exhibit);
        std::printf(
            "highlight %g, %g R%s: %zu of %zu beads, %s %.2f px, radius %.2f, off %.3f, scatter %.3f\n",
            bright, wide, stated ? ", stated" : "", beads.size(), exhibit.truth.size(),
            settled.refine.method.c_str(), settled.diameter_px, of.radius, of.off, of.scatter);
        EXPECT_EQ(beads.size(), exhibit.truth.size());
        EXPECT_NEAR(2 * of.radius, kDiameter, 0.03 * kDiameter);
        EXPECT_LT(of.off, 0.3);
        EXPECT_LT(of.scatter, 0.06);
      }
    }
}

// Before, the discs about the highlights were 1.026 times as high as wide.
TEST(GlossyBeads, HaveSquarePixelsUnlessThePictureIsStretched) {
  constexpr double kDiameter = 13.4;
  for (const double ratio : {1.0, 1.08}) {
    const Exhibit exhibit = glossy(kDiameter, 110, 0.3, 1);
    cv::Mat stretched;
    cv::resize(exhibit.picture, stretched, {}, 1, ratio, cv::INTER_CUBIC);
    imaging::LocatorOptions options;
    options.diameter_px = std::sqrt(ratio) * kDiameter;
    options.preprocess.bright = true;
    options.refine.method = "profile";
    imaging::RimAspect aspect;
    aspect.add(stretched, imaging::locate(stretched, options).beads);
    const imaging::Aspect found = aspect.value().value();
    ASSERT_TRUE(found.of_spacing);
    std::printf("stretched by %.2f: %.4f +- %.4f, spacing %.4f\n", ratio, found.ratio, found.error,
                *found.of_spacing);
    EXPECT_NEAR(*found.of_spacing, ratio, 0.01);
    EXPECT_EQ(found.doubt().empty(), ratio == 1.0) << found.doubt();
  }
}

// Highlights alone, without bodies, are all that can be found; that they are no beads is said.
TEST(GlossyBeads, WithoutBodiesAreNotTakenForSmallBeadsInSilence) {
  constexpr double kDiameter = 13.4;
  for (const bool highlights : {true, false}) {
    const double wide = highlights ? 0.18 * kDiameter : kDiameter;
    const int side = static_cast<int>(16 * kDiameter);
    Painter canvas(side, 25);
    for (const Place& p : at_rest(kDiameter, inner(side, 0.7 * kDiameter), 0.7, 4))
      canvas.disc(p.x, p.y, 0.5 * wide, [](double, double, double) { return 200.0; });
    const cv::Mat1b picture = canvas.exposed(0.85, 2.5, 1);
    imaging::OnePicture stack(picture);
    imaging::FramesAhead ahead(stack);
    imaging::LocatorOptions options;
    options.polarity_known = false;
    const imaging::LocatorConfiguration found = imaging::configure_locator(ahead, options);
    std::string said;
    for (const std::string& doubt : imaging::settings_doubts(found.choice, "exact")) said += doubt + "\n";
    EXPECT_EQ(said.find("highlights of larger beads") != std::string::npos, highlights)
        << found.locator.diameter_px << " px: " << said;
    EXPECT_EQ(said.find("--diameter 13") != std::string::npos, highlights) << said;
  }
}

}  // namespace
}  // namespace twincell::zoo::grey_walls_test
