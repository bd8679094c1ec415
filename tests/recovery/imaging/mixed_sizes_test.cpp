// Packings of several sizes, located as a first-time user does, without options. Sizes, beads and errors are
// checked against the truth and the Cramér-Rao bound of the same image.

#include <gtest/gtest.h>

#include <algorithm>
#include <cctype>
#include <cstdio>
#include <numbers>
#include <ostream>
#include <random>
#include <string>
#include <vector>

#include "imaging/benchmark/centre_scores.hpp"
#include "imaging/benchmark/cramer_rao_bound.hpp"
#include "imaging/benchmark/packing.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/settings/auto_configuration.hpp"

namespace twincell::imaging::mixed_sizes_test {
namespace {

using rendered::CentreScores;
using rendered::Picture;

struct Mixture {
  std::string name;
  std::vector<double> diameters, shares;
  double blur = 0.8, snr = 51, spread = 0;
  bool touching = true;
};

std::ostream& operator<<(std::ostream& out, const Mixture& m) {
  return out << m.name;
}

/// A square frame of 30 mean diameters, two thirds filled by touching discs, or one third by separate discs.
Picture picture_of(const Mixture& m, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::uniform_real_distribution<double> even(0, 1);
  double mean = 0;
  for (std::size_t k = 0; k < m.diameters.size(); ++k) mean += m.diameters[k] * m.shares[k];
  Picture p;
  p.width = p.height = static_cast<int>(30 * mean);
  p.blur = m.blur;
  std::vector<double> radii;
  for (double area = 0; area < (m.touching ? 0.66 : 0.3) * p.width * p.height;) {
    double pick = even(random);
    std::size_t k = 0;
    for (; k + 1 < m.diameters.size() && pick > m.shares[k]; ++k) pick -= m.shares[k];
    radii.push_back(0.5 * m.diameters[k] * (1 + m.spread * (2 * even(random) - 1)));
    area += std::numbers::pi * radii.back() * radii.back();
  }
  if (m.touching)
    p.discs = rendered::deposited(radii, {10, 0, p.width - 20.0, p.height - 10.0}, random);
  else
    p.discs = rendered::sparse(radii, {5, 5, p.width - 10.0, p.height - 10.0}, random);
  return p;
}

struct Seen {
  std::vector<double> diameters;
  std::string method;
  CentreScores::Summary scores;
};

Seen look(const Mixture& m) {
  const Picture picture = picture_of(m, 5);
  const cv::Mat1d light = rendered::expected(picture);
  const cv::Mat1b frame = rendered::expose(light, picture, m.snr, 5);
  LocatorOptions options;
  options.polarity_known = false;
  const auto found = find_settings(frame, options);
  if (!found) return {};
  options.diameter_px = found->diameter_px;
  options.other_diameters_px = found->other_diameters_px;
  options.preprocess.bright = found->bright;
  if (!found->method.empty()) options.refine.method = found->method;
  Seen seen{{options.diameter_px}, options.refine.method, {}};
  seen.diameters.insert(seen.diameters.end(), options.other_diameters_px.begin(),
                        options.other_diameters_px.end());
  std::vector<cv::Point2d> centres;
  for (const Detection& b : locate(frame, options).beads) centres.emplace_back(b.x, b.y);
  CentreScores scores;
  scores.add(picture, centres, rendered::cramer_rao_bound(light, picture, m.snr));
  seen.scores = scores.summary();
  std::printf("%-34s found:", m.name.c_str());
  for (const double d : seen.diameters) std::printf(" %.2f", d);
  std::printf(" px, %s; recall %.4f, precision %.4f, %.3f x bound\n", seen.method.c_str(), seen.scores.recall,
              seen.scores.precision, seen.scores.rms / seen.scores.bound);
  return seen;
}

class MixedSizes : public testing::TestWithParam<Mixture> {};

TEST_P(MixedSizes, AreFoundWithoutOptions) {
  const Seen seen = look(GetParam());
  ASSERT_EQ(seen.diameters.size(), GetParam().diameters.size());
  EXPECT_EQ(seen.method, "exact");
  for (std::size_t k = 0; k < seen.diameters.size(); ++k)
    EXPECT_NEAR(seen.diameters[k], GetParam().diameters[k], 0.01 * GetParam().diameters[k]);
  EXPECT_EQ(seen.scores.found, seen.scores.beads);
  EXPECT_EQ(seen.scores.invented, 0U);
  EXPECT_GE(seen.scores.rms, 0.85 * seen.scores.bound);
  EXPECT_LE(seen.scores.rms, 1.15 * seen.scores.bound);
}

INSTANTIATE_TEST_SUITE_P(
    Packings, MixedSizes,
    testing::Values(Mixture{"15 and 21 px", {15, 21}, {0.5, 0.5}},
                    Mixture{"15 px, 5 % of 21 px", {15, 21}, {0.95, 0.05}},
                    Mixture{"21 px, 5 % of 15 px", {15, 21}, {0.05, 0.95}},
                    Mixture{"15 px, 20 % of 33 px", {15, 33}, {0.8, 0.2}},
                    Mixture{"8 and 11 px", {8, 11}, {0.5, 0.5}},
                    Mixture{"30 and 42 px", {30, 42}, {0.5, 0.5}},
                    Mixture{"12, 16 and 22 px", {12, 16, 22}, {0.4, 0.3, 0.3}},
                    Mixture{"15 and 21 px, SNR 8.5", {15, 21}, {0.5, 0.5}, 0.8, 8.5},
                    Mixture{"15 and 21 px, blur 2 px", {15, 21}, {0.5, 0.5}, 2},
                    Mixture{"15 and 21 px, each within 2 %", {15, 21}, {0.5, 0.5}, 0.8, 51, 0.02},
                    Mixture{"15 and 21 px, apart", {15, 21}, {0.5, 0.5}, 0.8, 51, 0, false}),
    [](const auto& tested) {
      std::string name = tested.param.name;
      std::replace_if(
          name.begin(), name.end(), [](char c) { return std::isalnum(c) == 0; }, '_');
      return name;
    });

// A packing of one size is not reported as two sizes.
TEST(OneSize, StaysOne) {
  for (const Mixture& m : {Mixture{"15 px", {15}, {1}}, Mixture{"15 px within 10 %", {15}, {1}, 0.8, 51, 0.1},
                           Mixture{"15 px, blur 2 px", {15}, {1}, 2}, Mixture{"8 px", {8}, {1}}}) {
    const Seen seen = look(m);
    EXPECT_EQ(seen.diameters.size(), 1U) << m;
    EXPECT_EQ(seen.scores.found, seen.scores.beads) << m;
    EXPECT_EQ(seen.scores.invented, 0U) << m;
  }
}

// Sizes spread evenly by a quarter are not two sizes, but two sizes describe them.
TEST(OneSize, SpreadWideIsLocatedAsTwo) {
  const Seen seen = look({"15 px within 25 %", {15}, {1}, 0.8, 51, 0.25});
  EXPECT_EQ(seen.scores.found, seen.scores.beads);
  EXPECT_EQ(seen.scores.invented, 0U);
  EXPECT_LE(seen.scores.rms, 1.15 * seen.scores.bound);
}

}  // namespace
}  // namespace twincell::imaging::mixed_sizes_test
