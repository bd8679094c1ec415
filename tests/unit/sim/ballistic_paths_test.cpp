// Beads in straight relative motion with periodic images: the first touch, against a search over all images
// one by one.

#include "sim/event_driven/ballistic_paths.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <random>

namespace twincell::sim::ballistic_paths_test {
namespace {

constexpr int kBeads = 13;       // not a multiple of a vector length
constexpr double kHorizon = 3;   // time
constexpr double kPeriod = 3.5;  // sigma
constexpr int kImages = 8;       // on either side: no bead arrives from farther away within the horizon

struct Touch {
  double time = HUGE_VAL;
  int partner = -1;
};

/// Time after `from` at which two paths, one shifted by `shift`, first come within the distance `reach`.
double first_touch(const BallisticPath& p, const BallisticPath& q, const Vec3& shift, double reach,
                   double from) {
  const Vec3 w = p.b - q.b, d = p.a - q.a + shift + from * w;
  const double closing = d.dot(w), c = d.squaredNorm() - reach * reach;
  const double inside = closing * closing - w.squaredNorm() * c;
  if (closing >= 0 || inside <= 0) return HUGE_VAL;
  return from + c / (std::sqrt(inside) - closing);
}

class FlightLinesOf {
 public:
  FlightLinesOf(unsigned seed, int dimension, std::array<double, 3> period)
      : dimension_(dimension), period_(period), lines_(drawn_radii(seed), dimension, period) {
    std::mt19937_64 random(seed);
    std::uniform_real_distribution<double> place(0, kPeriod), height(0, 2 * kPeriod);
    std::normal_distribution<double> speed(0, 3);
    for (std::size_t i = 0; i < kBeads;) {
      BallisticPath line{{place(random), dimension == 2 ? 0 : place(random), height(random)},
                         {speed(random), dimension == 2 ? 0 : speed(random), speed(random)}};
      if (i == 0) line.b.z() = 0;
      if (i == 1) line.b = lines_[0].b;  // no relative motion
      bool free = true;
      for (std::size_t j = 0; j < i; ++j) {
        const Vec3 d = line.a - lines_[j].a;
        free = free && (d + lines_.shift(d)).norm() > lines_.radius(i) + lines_.radius(j);
      }
      if (!free) continue;
      lines_.put(i++, line);
    }
  }

  /// The first touch of bead i after the time `now`, from a search over every image of every other bead.
  [[nodiscard]] Touch among_all_images(std::size_t i, double now) const {
    Touch first;
    const auto reach_of = [&](std::size_t axis) { return period_[axis] > 0 ? kImages : 0; };
    for (std::size_t j = 0; j < kBeads; ++j) {
      if (j == i) continue;
      for (int x = -reach_of(0); x <= reach_of(0); ++x)
        for (int y = -reach_of(1); y <= reach_of(1); ++y)
          for (int z = -reach_of(2); z <= reach_of(2); ++z) {
            const Vec3 shift(x * period_[0], y * period_[1], z * period_[2]);
            const double t =
                first_touch(lines_[i], lines_[j], shift, lines_.radius(i) + lines_.radius(j), now);
            if (t < first.time) first = {t, static_cast<int>(j)};
          }
    }
    return first;
  }
  /// The same from first_hit(), as in event-driven motion: the search is repeated at the time that
  /// first_hit() returns.
  [[nodiscard]] Touch by_looking(std::size_t i, double now, int& looks) const {
    for (;;) {
      const BallisticPaths::Hit hit = lines_.first_hit(i, now);
      ++looks;
      EXPECT_FALSE(hit.overlap);
      if (hit.time <= hit.until) return {hit.time, hit.partner};
      if (hit.until > kHorizon) return {};
      EXPECT_GE(hit.until, now);
      now = std::nextafter(hit.until, HUGE_VAL);
    }
  }

 private:
  static std::vector<double> drawn_radii(unsigned seed) {
    std::mt19937_64 random(seed + 1);
    std::uniform_real_distribution<double> radius(0.2, 0.4);
    std::vector<double> radii(kBeads);
    for (double& r : radii) r = radius(random);
    return radii;
  }

  int dimension_;
  std::array<double, 3> period_;
  BallisticPaths lines_;
};

TEST(BallisticPaths, FindTheFirstTouchAmongAllImages) {
  const struct {
    int dimension;
    std::array<double, 3> period;
  } cells[] = {
      {2, {kPeriod, 0, 0}}, {3, {kPeriod, kPeriod, 0}}, {3, {kPeriod, kPeriod, 2 * kPeriod}}, {3, {0, 0, 0}}};
  int touches = 0;
  for (const auto& cell : cells)
    for (unsigned seed = 1; seed <= 40; ++seed) {
      const FlightLinesOf beads(seed, cell.dimension, cell.period);
      for (std::size_t i = 0; i < kBeads; ++i) {
        int looks = 0;
        const Touch found = beads.by_looking(i, 0, looks), first = beads.among_all_images(i, 0);
        if (first.time > kHorizon) {
          EXPECT_GT(found.time, kHorizon);
          continue;
        }
        ++touches;
        EXPECT_NEAR(found.time, first.time, 1e-11) << "seed " << seed << " bead " << i;
        EXPECT_EQ(found.partner, first.partner) << "seed " << seed << " bead " << i;
      }
    }
  EXPECT_GT(touches, 1000);
}

TEST(BallisticPaths, DoNotWaitForImagesThatPassAboveOrBelow) {
  // Bead 1 crosses the cell at a height of 3 above bead 0 and reaches its first image at x = 3.5 - 1.
  const auto until = [](double height, double sinks) {
    BallisticPaths lines({0.5, 0.5}, 3, {kPeriod, kPeriod, 0});
    lines.put(0, {{0, 0, 0}, {0, 0, 0}});
    lines.put(1, {{0, 0, height}, {1, 0, -sinks}});
    return lines.first_hit(0, 0).until;
  };
  EXPECT_GT(until(3, 0), 1e90);       // always above
  EXPECT_EQ(until(3, -1), HUGE_VAL);  // rises
  // Passes the height of bead 0 between 0.5 and 1, before it reaches the image.
  EXPECT_EQ(until(3, 4), HUGE_VAL);
  EXPECT_NEAR(until(3, 0.5), 4, 1e-12);      // reaches the image at 2.5, at the height of bead 0 from 4 on
  EXPECT_NEAR(until(1.5, 0.5), 2.5, 1e-12);  // at the height of bead 0 from 1 to 5, reaches the image at 2.5
  EXPECT_NEAR(until(0.5, 0.0001), 2.5, 1e-12);  // overlaps in height at all times
}

}  // namespace
}  // namespace twincell::sim::ballistic_paths_test
