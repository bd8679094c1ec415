// Crystals of opaque discs that fill the frame, as a camera sees them that looks into the bed. There is no
// bare background, the gaps resemble the discs, and the votes of neighbouring rims meet everywhere. One
// frame, no options.

#include <gtest/gtest.h>

#include <cstdio>
#include <cstdlib>
#include <random>
#include <string>
#include <vector>

#include "imaging/benchmark/centre_scores.hpp"
#include "imaging/benchmark/cramer_rao_bound.hpp"
#include "imaging/benchmark/picture.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/track/locate_stack.hpp"
#include "tests/support/hexagonal_sites.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::imaging::full_crystal_test {
namespace {

using rendered::CentreScores;
using rendered::Disc;
using rendered::Picture;

constexpr double kSnr = 51;

struct Crystal {
  double diameter, turned, blur;
  double jitter = 0;     // standard deviation of the positions, diameters
  bool bright = false;   // light discs on black
  double most = 5;       // upper limit of rms, in units of the bound
  std::size_t lost = 0;  // a bead of 12 px has its centre 0.005 px inside the frame
};

/// Hexagonal, with neighbours in contact except for the jitter; the lattice continues beyond all four sides
/// of the frame.
Picture picture_of(const Crystal& c) {
  Picture p;
  p.width = 300, p.height = 300;
  p.blur = c.blur;
  if (c.bright) p.light = 22;
  std::mt19937_64 random(7);
  std::normal_distribution<double> normal(0, c.jitter * c.diameter);
  for (const cv::Point2d& site :
       hexagonal_sites(c.diameter, c.turned, static_cast<int>(2 * p.width / c.diameter))) {
    Disc d;
    d.x = 0.5 * p.width + 0.3 + site.x + normal(random);
    d.y = 0.5 * p.height + 0.2 + site.y + normal(random);
    d.radius = 0.5 * c.diameter * (1 - 3 * c.jitter);
    d.contrast = c.bright ? -8 : 1;
    if (d.x > -c.diameter && d.y > -c.diameter && d.x < p.width + c.diameter && d.y < p.height + c.diameter)
      p.discs.push_back(d);
  }
  return p;
}

class FullCrystal : public testing::TestWithParam<Crystal> {};

TEST_P(FullCrystal, IsFoundUnasked) {
  const Crystal& c = GetParam();
  const Picture truth = picture_of(c);
  const cv::Mat1d light = rendered::expected(truth);
  const TemporaryFolder folder;
  const std::string name = (folder.path() / "frame.png").string();
  write_picture(name, rendered::expose(light, truth, kSnr, 3));
  if (const char* keep = std::getenv("TWINCELL_FAILED_FRAMES"))
    write_picture(std::string(keep) + "/crystal" + std::to_string(int(c.diameter)) + "_" +
                      std::to_string(int(10 * c.blur)) + (c.jitter > 0 ? "j" : "") + ".png",
                  read_picture(name));
  LocatorOptions options;
  options.polarity_known = false;
  CentreScores scores;
  const auto frames = open_frames(name);
  FramesAhead ahead(*frames);
  const LocatorOptions settled = configure_locator(ahead, options).locator;
  locate_stack(ahead, settled, 1, [&](std::int64_t, const cv::Mat&, const Located& located) {
    std::vector<cv::Point2d> centres;
    for (const Detection& b : located.beads) centres.emplace_back(b.x, b.y);
    scores.add(truth, centres, rendered::cramer_rao_bound(light, truth, kSnr));
  });
  const CentreScores::Summary m = scores.summary();
  std::printf("%g px: diameter %.2f px, %s, %s; recall %.4f, precision %.4f, rms %.4f px, %.2f x bound\n",
              c.diameter, settled.diameter_px, settled.preprocess.bright ? "bright" : "dark",
              settled.refine.method.c_str(), m.recall, m.precision, m.rms, m.rms / m.bound);
  EXPECT_EQ(settled.preprocess.bright, c.bright);
  EXPECT_GE(m.found + c.lost, m.beads);
  EXPECT_EQ(m.invented, 0U);
  const double diameter = c.diameter * (1 - 3 * c.jitter);
  EXPECT_NEAR(settled.diameter_px, diameter, 0.1 * diameter);
  EXPECT_GE(m.rms, 0.8 * m.bound);
  EXPECT_LE(m.rms, c.most * m.bound);
}

INSTANTIATE_TEST_SUITE_P(Discs, FullCrystal,
                         testing::Values(Crystal{8, 0.3, 0.8}, Crystal{10, 0.3, 0.8}, Crystal{10, 0, 0.8},
                                         Crystal{10, 0.1, 0.8, 0.01, false, 8, 1},
                                         Crystal{10, 0.3, 0.8, 0, true},
                                         Crystal{12, 0.3, 0.8, 0, false, 5, 1},
                                         Crystal{12, 0.2, 1.2, 0, false, 10, 1}, Crystal{15, 0, 0.8},
                                         Crystal{15, 0.3, 1.5, 0, false, 10}, Crystal{20, 0.1, 0.8},
                                         Crystal{32, 0.3, 0.8}),
                         [](const auto& crystal) {
                           const Crystal& c = crystal.param;
                           return "px" + std::to_string(static_cast<int>(c.diameter)) + "_turned" +
                                  std::to_string(static_cast<int>(10 * c.turned)) + "_blur" +
                                  std::to_string(static_cast<int>(10 * c.blur)) +
                                  (c.jitter > 0 ? "_jitter" : "") + (c.bright ? "_bright" : "");
                         });

}  // namespace
}  // namespace twincell::imaging::full_crystal_test
