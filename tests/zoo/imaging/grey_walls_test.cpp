// Black beads in a cell whose walls and plate are grey, as aluminium in back light: even grey is not tiled
// with discs, and beads are not called tracers because of it.

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <vector>

#include "imaging/benchmark/score.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/settings/auto_configuration.hpp"
#include "imaging/settings/settings_choice.hpp"
#include "tests/zoo/imaging/kinds.hpp"

namespace twincell::zoo {
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

}  // namespace
}  // namespace twincell::zoo
