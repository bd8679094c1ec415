// Discs that are not uniform, and uniform discs on an uneven background, located without any option from one
// frame. Every disc is found, there are no false detections, and the sizes are those of the rims. Errors are
// bounded from below and above by the Cramér-Rao bound of one such disc alone, all its edges together
// (neighbours in contact change the bound by a few per cent).

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <opencv2/imgproc.hpp>
#include <random>
#include <string>
#include <vector>

#include "imaging/benchmark/centre_scores.hpp"
#include "imaging/benchmark/packing.hpp"
#include "imaging/benchmark/picture.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/track/locate_stack.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::imaging::looks_test {
namespace {

using rendered::CentreScores;
using rendered::Disc;
using rendered::Picture;

constexpr double kSnr = 51;
constexpr std::array kDiameters = {12.0, 15.0, 32.0};

/// Permitted error of the diameter, px: the blur shifts the rims of small discs more.
double tolerance(double diameter) {
  return diameter < 15 ? 1 : 0.06 * diameter;
}

/// One uniform disc of the concentric stack that makes up a bead.
struct Layer {
  double share;     // fraction of the radius
  double contrast;  // that this layer adds
};

enum class Ground { even, dots, cloth };

struct Look {
  std::string name;
  std::vector<Layer> layers;
  double light;  // grey levels of the background
  Ground ground = Ground::even;
  double most = 2.2;  // upper limit of rms, in units of the bound
};

void PrintTo(const Look& look, std::ostream* out) {
  *out << look.name;
}

const std::vector<Look> kLooks = {
    {"clear", {{1, 0.88}, {0.78, -0.73}}, 190},                                 // clear, a dark rim
    {"thin", {{1, 0.75}, {0.88, -0.45}}, 190, Ground::even, 1.4},               // grey, a dark rim
    {"ringed", {{1, 0.95}, {0.65, -0.7}, {0.4, 0.7}}, 190, Ground::even, 1.4},  // black, with a light
                                                                                // ring
    {"white", {{1, -8}, {0.75, 7}, {0.5, -7}}, 22},  // white, a dark ring, on black
    {"target", {{1, -1.0}, {0.8, 1.7}, {0.55, -1.7}}, 100, Ground::even, 1.4},  // the same on grey
    {"on_dots", {{1, 0.95}}, 190, Ground::dots, 30},    // black, on a perforated table
    {"on_cloth", {{1, 0.95}}, 190, Ground::cloth, 30},  // black, on cloth, unevenly lit
};

/// Transmission of the background, as a fraction of the light.
cv::Mat1d ground_of(const Look& look, cv::Size size, double diameter) {
  cv::Mat1d ground(size, 1.0);
  if (look.ground == Ground::dots) {
    const double pitch = 0.62 * diameter, radius = 0.16 * diameter;
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const double dx = std::remainder(x, pitch), dy = std::remainder(y, pitch);
        ground(y, x) -= 0.5 * std::clamp(radius - std::hypot(dx, dy) + 0.5, 0.0, 1.0);
      }
    cv::GaussianBlur(ground, ground, {0, 0}, 0.8);
  } else if (look.ground == Ground::cloth) {
    std::mt19937_64 random(5);
    std::normal_distribution<double> normal;
    for (double& g : ground) g = normal(random);
    cv::GaussianBlur(ground, ground, {0, 0}, 0.2 * diameter);
    cv::Scalar mean, scatter;
    cv::meanStdDev(ground, mean, scatter);
    for (int y = 0; y < size.height; ++y)
      for (int x = 0; x < size.width; ++x) {
        const double u = 2.0 * x / size.width - 1, v = 2.0 * y / size.height - 1;
        ground(y, x) = (1 + 0.1 * ground(y, x) / scatter[0]) * (1 - 0.15 * (u * u + v * v));
      }
  }
  return ground;
}

Picture blank(const Look& look, int width, int height) {
  Picture p;
  p.width = width, p.height = height;
  p.light = look.light;
  return p;
}

void put(Picture& p, const Look& look, double x, double y, double radius) {
  for (const Layer& layer : look.layers) {
    Disc d;
    d.x = x, d.y = y, d.radius = layer.share * radius, d.contrast = layer.contrast;
    p.discs.push_back(d);
  }
}

/// Variance of the noise that `expose` adds, plus that of rounding.
double variance(double level, const Picture& p) {
  const double sigma = p.light / kSnr;
  return sigma * sigma *
             (rendered::kReadShare +
              (1 - rendered::kReadShare) * std::max(0.0, level - p.pedestal) / p.light) +
         1.0 / 12;
}

/// By symmetry, radius and contrast do not affect the bound on position: 1/sqrt(sum (dI/dx)^2/V).
double bound_of(const Look& look, double diameter) {
  constexpr double kStep = 0.01;
  const int side = static_cast<int>(2 * diameter);
  double sum = 0;
  std::vector<cv::Mat1d> levels;
  for (const double dx : {-kStep, kStep}) {
    Picture p = blank(look, side, side);
    put(p, look, 0.5 * side + dx, 0.5 * side + 0.2, 0.5 * diameter);
    levels.push_back(rendered::expected(p));
  }
  const Picture p = blank(look, side, side);
  for (int y = 0; y < side; ++y)
    for (int x = 0; x < side; ++x)
      sum += std::pow((levels[1](y, x) - levels[0](y, x)) / (2 * kStep), 2) / variance(levels[0](y, x), p);
  return 1 / std::sqrt(sum);
}

class Looks : public testing::TestWithParam<Look> {
 protected:
  void see(const std::string& arrangement, double diameter) {
    const Look& look = GetParam();
    const int width = static_cast<int>(16 * diameter), height = static_cast<int>(16 * diameter);
    std::mt19937_64 random(static_cast<std::uint64_t>(diameter));
    const double margin = 0.4 * diameter;
    const cv::Rect2d room(margin, margin, width - 2 * margin, height - 1.7 * margin);
    const bool apart = arrangement == "apart";
    const std::vector<double> radii(apart ? 80 : 130, 0.5 * diameter);
    const std::vector<Disc> places = apart ? rendered::sparse(radii, room, random)
                                     : arrangement == "crystal"
                                         ? rendered::hexagonal(radii.size(), 0.5 * diameter, room, random)
                                         : rendered::deposited(radii, room, random);
    Picture picture = blank(look, width, height), truth = picture;
    for (const Disc& d : places) {
      put(picture, look, d.x, d.y, d.radius);
      truth.discs.push_back(d);
    }
    cv::Mat1d light = rendered::expected(picture);
    const cv::Mat1d ground = ground_of(look, light.size(), diameter);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x)
        light(y, x) = picture.pedestal + ground(y, x) * (light(y, x) - picture.pedestal);
    const TemporaryFolder folder;
    const std::string name = (folder.path() / "frame.png").string();
    write_picture(name, rendered::expose(light, picture, kSnr, 3));
    if (const char* keep = std::getenv("TWINCELL_FAILED_FRAMES"))
      write_picture(
          std::string(keep) + "/" + look.name + "_" + arrangement + std::to_string(int(diameter)) + ".png",
          read_picture(name));

    LocatorOptions options;
    options.polarity_known = false;
    CentreScores scores;
    const double bound = bound_of(look, diameter);
    const auto frames = open_frames(name);
    FramesAhead ahead(*frames);
    const LocatorOptions settled = configure_locator(ahead, options).locator;
    locate_stack(ahead, settled, 1, [&](std::int64_t, const cv::Mat&, const Located& located) {
      std::vector<cv::Point2d> centres;
      for (const Detection& b : located.beads) centres.emplace_back(b.x, b.y);
      scores.add(truth, centres, std::vector<double>(places.size(), bound));
    });
    const CentreScores::Summary m = scores.summary();
    std::printf(
        "%s, %s, %g px: diameter %.2f px, %s, %s; recall %.4f, precision %.4f, rms %.4f px, %.2f x bound\n",
        look.name.c_str(), arrangement.c_str(), diameter, settled.diameter_px,
        settled.preprocess.bright ? "bright" : "dark", settled.refine.method.c_str(), m.recall, m.precision,
        m.rms, m.rms / m.bound);
    EXPECT_EQ(m.found, m.beads) << arrangement << ' ' << diameter;
    EXPECT_EQ(m.invented, 0U) << arrangement << ' ' << diameter;
    EXPECT_NEAR(settled.diameter_px, diameter, tolerance(diameter)) << arrangement;
    EXPECT_GE(m.rms, 0.8 * m.bound) << arrangement << ' ' << diameter;
    EXPECT_LE(m.rms, look.most * m.bound) << arrangement << ' ' << diameter;
  }
};

// A square frame was once transposed in place, so the second location saw its mirror image.
TEST(SquareFrame, StaysAsItIs) {
  cv::Mat1b frame(64, 64, uchar{200});
  for (int y = 20; y < 35; ++y)
    for (int x = 40; x < 60; ++x) frame(y, x) = 10;
  const cv::Mat before = frame.clone();
  LocatorOptions options;
  options.diameter_px = 15;
  for (const cv::Mat1b& picture : {frame, cv::Mat1b(frame.t())}) {
    const cv::Mat kept = picture.clone();
    locate(picture, options);
    EXPECT_EQ(cv::norm(picture, kept, cv::NORM_INF), 0);
  }
  EXPECT_EQ(cv::norm(frame, before, cv::NORM_INF), 0);
}

// Profile and radii are known up to a common stretch, which the rim fixes. Before, the radius followed the
// size that was searched for, by up to 14 %.
TEST(CommonProfile, RadiusIndependentOfSearchDiameter) {
  constexpr double kDiameter = 22;
  constexpr int kSide = 260;
  const Look& look = kLooks.front();
  std::mt19937_64 random(5);
  Picture picture = blank(look, kSide, kSide);
  const std::vector<double> radii(30, kDiameter / 2);
  for (const Disc& d : rendered::sparse(radii, cv::Rect2d(12, 12, kSide - 24, kSide - 24), random))
    put(picture, look, d.x, d.y, d.radius);
  const cv::Mat grey = rendered::expose(rendered::expected(picture), picture, kSnr, 3);
  for (const double searched : {0.9 * kDiameter, kDiameter, 1.1 * kDiameter}) {
    LocatorOptions options;
    options.diameter_px = searched;
    options.refine.method = "profile";
    const std::vector<Detection> beads = locate(grey, options).beads;
    ASSERT_EQ(beads.size(), radii.size()) << searched;
    double sum = 0;
    for (const Detection& b : beads) sum += 2 * b.radius;
    EXPECT_NEAR(sum / static_cast<double>(beads.size()), kDiameter, 0.02 * kDiameter) << searched;
  }
}

TEST_P(Looks, SeparatedBeadsAreFoundWithoutOptions) {
  for (const double diameter : kDiameters) see("apart", diameter);
}

TEST_P(Looks, TouchingAreFoundUnasked) {
  for (const double diameter : kDiameters) see("touching", diameter);
}

// Only six small gaps separate a disc from its neighbours: votes alone are too few, or meet a pixel or two
// from the centre.
TEST_P(Looks, CrystalsAreFoundUnasked) {
  for (const double diameter : kDiameters) see("crystal", diameter);
}

INSTANTIATE_TEST_SUITE_P(Discs, Looks, testing::ValuesIn(kLooks),
                         [](const auto& look) { return look.param.name; });

}  // namespace
}  // namespace twincell::imaging::looks_test
