// Discs that absorb a tenth to a third of the light, located without options, and at given size and polarity,
// against the truth and the Cramér-Rao bound of the same image.

#include <gtest/gtest.h>

#include <cstdio>
#include <numbers>
#include <random>
#include <vector>

#include "imaging/benchmark/centre_scores.hpp"
#include "imaging/benchmark/cramer_rao_bound.hpp"
#include "imaging/benchmark/packing.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/track/locate_stack.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::imaging::pale_discs_test {
namespace {

using rendered::CentreScores;
using rendered::Picture;

struct Pale {
  double contrast, snr;
  bool touching;
  int opaque_of_ten = 0;  ///< discs that absorb all light; the others have `contrast`
};

Picture picture_of(const Pale& c) {
  std::mt19937_64 random(4);
  Picture p;
  p.width = p.height = 450;
  const std::vector<double> radii(c.touching ? 700 : 350, 7.5);
  if (c.touching)
    p.discs = rendered::deposited(radii, {10, 0, p.width - 20.0, p.height - 10.0}, random);
  else
    p.discs = rendered::sparse(radii, {5, 5, p.width - 10.0, p.height - 10.0}, random);
  for (std::size_t k = 0; k < p.discs.size(); ++k)
    p.discs[k].contrast = static_cast<int>(k % 10) < c.opaque_of_ten ? 1 : c.contrast;
  return p;
}

CentreScores::Summary look(const Pale& c, LocatorOptions options) {
  const Picture picture = picture_of(c);
  const cv::Mat1d light = rendered::expected(picture);
  const TemporaryFolder folder;
  const std::string name = (folder.path() / "frame.png").string();
  write_picture(name, rendered::expose(light, picture, c.snr, 4));
  const auto frames = open_frames(name);
  CentreScores scores;
  FramesAhead ahead(*frames);
  const LocatorOptions settled = configure_locator(ahead, options).locator;
  locate_stack(ahead, settled, 1, [&](std::int64_t, const cv::Mat&, const Located& located) {
    std::vector<cv::Point2d> centres;
    for (const Detection& b : located.beads) centres.emplace_back(b.x, b.y);
    scores.add(picture, centres, rendered::cramer_rao_bound(light, picture, c.snr));
  });
  const CentreScores::Summary m = scores.summary();
  std::printf(
      "contrast %.2f, SNR %g, %s: %.2f px, %s, contrast %.2f; recall %.4f, precision %.4f, %.2f x bound\n",
      c.contrast, c.snr, c.touching ? "touching" : "apart", settled.diameter_px,
      settled.refine.method.c_str(), settled.preprocess.contrast, m.recall, m.precision, m.rms / m.bound);
  return m;
}

class PaleDiscs : public testing::TestWithParam<Pale> {
 protected:
  void expect_at_the_bound(const CentreScores::Summary& m) {
    EXPECT_EQ(m.found, m.beads);
    EXPECT_EQ(m.invented, 0U);
    EXPECT_GE(m.rms, 0.85 * m.bound);
    EXPECT_LE(m.rms, 1.15 * m.bound);
  }
};

TEST_P(PaleDiscs, AreFoundWithoutOptions) {
  LocatorOptions options;
  options.polarity_known = false;
  expect_at_the_bound(look(GetParam(), options));
}

TEST_P(PaleDiscs, AreFoundAtAGivenSize) {
  LocatorOptions options;
  options.diameter_px = 15;
  expect_at_the_bound(look(GetParam(), options));
}

// One sweep of "fast" would lose discs that the votes do not propose.
TEST(PaleTracersInOneSweep, AreFound) {
  LocatorOptions options;
  options.refine.method = "fast";
  const CentreScores::Summary m = look({0.6, 51, true, 9}, options);
  EXPECT_EQ(m.found, m.beads);
  EXPECT_EQ(m.invented, 0U);
}

// Pale tracers among opaque beads, as dyed or hollow ones.
class PaleTracers : public PaleDiscs {};

TEST_P(PaleTracers, AreFoundWithoutOptions) {
  expect_at_the_bound(look(GetParam(), {}));
}

INSTANTIATE_TEST_SUITE_P(Contrasts, PaleTracers,
                         testing::Values(Pale{0.4, 51, true, 9}, Pale{0.3, 51, false, 9}),
                         [](const auto& tested) {
                           return (tested.param.touching ? "touching" : "apart") +
                                  std::to_string(static_cast<int>(100 * tested.param.contrast + 0.5));
                         });

INSTANTIATE_TEST_SUITE_P(Contrasts, PaleDiscs,
                         testing::Values(Pale{0.3, 51, true}, Pale{0.2, 164, false}, Pale{0.1, 164, false}),
                         [](const auto& tested) {
                           return "percent" +
                                  std::to_string(static_cast<int>(100 * tested.param.contrast + 0.5));
                         });

}  // namespace
}  // namespace twincell::imaging::pale_discs_test
