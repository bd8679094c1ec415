// Beads located in frames of the synthetic camera, compared with the Cramer-Rao bound of 0.36/SNR px per
// coordinate (15 px disc, blur 0.8 px). Recall, precision, bias and scatter are asserted separately.
#include "imaging/locate/locator.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <iostream>
#include <random>

#include "imaging/benchmark/score.hpp"
#include "imaging/camera/synthetic_camera.hpp"
#include "imaging/settings/auto_configuration.hpp"
#include "imaging/settings/size_hypotheses.hpp"

namespace twincell::locator_test {

using namespace imaging;

namespace {

constexpr double kSide = 22;  // sigma

using Packing = std::vector<Vec3>;

// On a grid of 2 sigma, each bead displaced at random by less than half a sigma.
Packing sparse() {
  std::mt19937_64 generator(1);
  std::uniform_real_distribution<double> move(-0.4, 0.4);
  Packing beads;
  for (double z = 2; z < kSide - 1; z += 2)
    for (double x = 2; x < kSide - 1; x += 2) beads.emplace_back(x + move(generator), 0, z + move(generator));
  return beads;
}

Packing hexagonal() {
  Packing beads;
  for (int row = 0; row < 16; ++row)
    for (int i = 0; i < 16; ++i) beads.emplace_back(2 + i + 0.5 * (row % 2), 0, 2 + std::sqrt(0.75) * row);
  return beads;
}

// Random positions are pushed apart until almost no beads overlap, then scaled up until none do.
Packing random_touching() {
  std::mt19937_64 generator(2);
  std::uniform_real_distribution<double> place(0, 14);
  Packing beads;
  for (int i = 0; i < 200; ++i) {
    const double x = place(generator);
    beads.emplace_back(x, 0, place(generator));
  }
  double closest = 0;
  for (int sweep = 0; sweep < 3000; ++sweep) {
    closest = 1;
    for (std::size_t i = 0; i < beads.size(); ++i)
      for (std::size_t j = 0; j < i; ++j) {
        const Vec3 d = beads[i] - beads[j];
        const double r = d.norm();
        if (r >= 1) continue;
        closest = std::min(closest, r);
        const Vec3 push = 0.5 * (1 - r) / r * d;
        beads[i] += push;
        beads[j] -= push;
      }
    for (Vec3& b : beads) b = b.cwiseMax(0).cwiseMin(14);
  }
  for (Vec3& b : beads) b = b / closest + Vec3(2, 0, 2);
  return beads;
}

struct Outcome {
  Score score;
  double bound;
};

Outcome locate_packing(const Packing& beads, double snr) {
  TrajectoryInfo info;
  info.n_beads = beads.size();
  info.box.lower = Vec3(0, -0.5, 0);
  info.box.upper = Vec3(kSide, 0.5, kSide);
  CameraOptions options;
  options.electrons_per_level = 0;
  options.read_noise = options.backlight / snr;
  const SyntheticCamera camera(options, info);
  Frame frame;
  frame.plate_height = 0;
  frame.position = beads;
  std::vector<TruthBead> truth;
  for (std::size_t k = 0; k < beads.size(); ++k) {
    const PixelPoint p = camera.pixel_frame().pixel_from_cell(beads[k]);
    truth.push_back({static_cast<std::int64_t>(k), p.x_px, p.y_px, camera.radius_px(k), 0, true});
  }
  LocatorOptions locator;
  locator.diameter_px = options.pixels_per_sigma;
  Scorer scorer;
  for (frame.step = 0; frame.step < 2; ++frame.step) {
    std::vector<FoundBead> found;
    for (const Detection& b : locate(camera.expose(frame), locator).beads) found.push_back({b.x, b.y, -1});
    scorer.add(truth, found);
  }
  const Outcome o{scorer.score(), 0.36 / snr};
  std::cout << beads.size() << " beads, SNR " << snr << ": recall " << o.score.recall() << ", precision "
            << o.score.precision() << ", rms " << o.score.rms << " px, bias " << o.score.bias_x << " "
            << o.score.bias_y << " px, bound " << o.bound << " px\n";
  return o;
}

void expect_near_bound(const Outcome& o, double times) {
  EXPECT_EQ(o.score.recall(), 1);
  EXPECT_EQ(o.score.precision(), 1);
  EXPECT_LE(o.score.rms, times * o.bound);
  EXPECT_GE(o.score.rms, 0.8 * o.bound) << "better than any unbiased fit can be: is there noise at all?";
  EXPECT_LE(std::abs(o.score.bias_x), 0.3 * o.bound);
  EXPECT_LE(std::abs(o.score.bias_y), 0.3 * o.bound);
}

}  // namespace

TEST(Locator, Sparse) {
  expect_near_bound(locate_packing(sparse(), 51), 1.5);
  expect_near_bound(locate_packing(sparse(), 18.5), 1.5);
}

TEST(Locator, HexagonalTouching) {
  expect_near_bound(locate_packing(hexagonal(), 51), 1.5);
  expect_near_bound(locate_packing(hexagonal(), 18.5), 1.5);
}

TEST(Locator, RandomTouching) {
  expect_near_bound(locate_packing(random_touching(), 51), 1.5);
  expect_near_bound(locate_packing(random_touching(), 18.5), 1.5);
}

TEST(Locator, FramesWithoutBeads) {
  LocatorOptions locator;
  locator.diameter_px = 15;
  std::mt19937_64 generator(3);
  std::normal_distribution<float> noise(200, 4);
  cv::Mat1b noisy(200, 300);
  for (auto& v : noisy) v = static_cast<uchar>(noise(generator));
  for (const cv::Mat1b& frame : {cv::Mat1b(200, 300, uchar{0}), cv::Mat1b(200, 300, uchar{255}), noisy,
                                 cv::Mat1b(1, 1, uchar{9}), cv::Mat1b(1, 300, uchar{200}), cv::Mat1b()})
    EXPECT_EQ(locate(frame, locator).beads.size(), 0U) << frame.size();
}

TEST(Locator, DiameterIsEstimatedToAFewPerCent) {
  for (const double diameter : {10.0, 15.0, 24.0}) {
    TrajectoryInfo info;
    const Packing beads = sparse();
    info.n_beads = beads.size();
    info.box.upper = Vec3(kSide, 0.5, kSide);
    CameraOptions options;
    options.pixels_per_sigma = diameter;
    Frame frame;
    frame.position = beads;
    const double found = estimate_diameter(SyntheticCamera(options, info).expose(frame), {});
    std::cout << "diameter " << diameter << " px: estimated " << found << " px\n";
    EXPECT_NEAR(found, diameter, 0.05 * diameter);
  }
}

}  // namespace twincell::locator_test
