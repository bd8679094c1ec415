// Discs that overlap in projection (overlapping_fit.hpp), painted without its model.

#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <vector>

#include "imaging/locate/locator.hpp"
#include "tests/zoo/imaging/kinds.hpp"

namespace twincell::zoo::overlapping_test {
namespace {

std::vector<imaging::Detection> beads_of(const cv::Mat1b& picture, double diameter, const char* method) {
  imaging::LocatorOptions options;
  options.diameter_px = diameter;
  options.refine.method = method;
  return imaging::locate(picture, options).beads;
}

/// The bead nearest to a place, and its distance.
std::pair<const imaging::Detection*, double> nearest(const std::vector<imaging::Detection>& beads, double x,
                                                     double y) {
  std::pair<const imaging::Detection*, double> best{nullptr, HUGE_VAL};
  for (const imaging::Detection& b : beads)
    if (const double r = std::hypot(b.x - x, b.y - y); r < best.second) best = {&b, r};
  return best;
}

// Pairs at all distances, opaque and translucent: both are found in their places, and those that overlap by
// more than a quarter of a radius are marked.
TEST(Overlapping, BothDiscsOfAPairAreFound) {
  constexpr int kPairs = 6;
  for (const double transmitted : {0.0, 0.5})
    for (const double d : {12.0, 20.0, 40.0}) {
      const int side = static_cast<int>((2.2 * kPairs + 1) * d);
      Painter canvas(side, kLight);
      Places places;
      for (int i = 0; i < kPairs; ++i)
        for (int j = 0; j < kPairs; ++j) {
          const double apart = (0.45 + 0.018 * (kPairs * j + i)) * d, turn = 0.4 * (i + kPairs * j);
          const double x = (1.4 + 2.2 * i) * d, y = (1.4 + 2.2 * j) * d;
          for (const int sign : {-1, 1})
            places.push_back(
                {x + 0.5 * sign * apart * std::cos(turn), y + 0.5 * sign * apart * std::sin(turn), 0.5 * d});
        }
      for (const Place& p : places)
        canvas.disc(p.x, p.y, p.radius,
                    [&](double, double, double below) { return std::max(kBlack, transmitted * below); });
      const std::vector<imaging::Detection> beads =
          beads_of(canvas.exposed(kBlur, kNoise, 21), d, "overlapping");
      EXPECT_EQ(beads.size(), places.size()) << d << " px, transmitted " << transmitted;
      double squares = 0, in_sigmas = 0;
      for (std::size_t k = 0; k < places.size(); ++k) {
        const Place &p = places[k], &other = places[k ^ 1U];
        const auto [bead, off] = nearest(beads, p.x, p.y);
        ASSERT_NE(bead, nullptr);
        EXPECT_LT(off, 0.3) << d << " px, pair " << k / 2;
        squares += off * off,
            in_sigmas += off * off / (bead->sigma_x * bead->sigma_x + bead->sigma_y * bead->sigma_y);
        const double apart = std::hypot(p.x - other.x, p.y - other.y) / d;
        if (std::abs(apart - 0.875) > 0.02) {
          EXPECT_EQ(bead->overlap, apart < 0.875) << apart;
        }
      }
      const double n = static_cast<double>(places.size()), rms = std::sqrt(squares / (2 * n));
      std::printf("%2g px, transmitted %g: rms %.4f px, %.2f stated errors\n", d, transmitted, rms,
                  std::sqrt(in_sigmas / n));
      EXPECT_LT(rms, 0.05);
      EXPECT_GT(std::sqrt(in_sigmas / n), 0.5);
      EXPECT_LT(std::sqrt(in_sigmas / n), 2);
    }
}

// Where no discs overlap, the fit is that of one layer.
TEST(Overlapping, OneLayerIsLocatedAsByTheExactFit) {
  const Exhibit exhibit = opaque(14);
  const std::vector<imaging::Detection> exact = beads_of(exhibit.picture, 14, "exact"),
                                        mine = beads_of(exhibit.picture, 14, "overlapping");
  EXPECT_EQ(mine.size(), exact.size());
  double squares = 0;
  for (const imaging::Detection& b : exact) {
    const auto [bead, off] = nearest(mine, b.x, b.y);
    ASSERT_NE(bead, nullptr);
    EXPECT_FALSE(bead->overlap);
    EXPECT_LT(off, 0.15);
    squares += off * off;
  }
  std::printf("rms difference %.4f px\n", std::sqrt(squares / (2 * static_cast<double>(exact.size()))));
}

}  // namespace
}  // namespace twincell::zoo::overlapping_test
