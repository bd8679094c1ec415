// Dirt that stays in place while the beads move: a blank frame, or the stack itself, removes it.

#include "imaging/preprocess/flat_field.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <iostream>
#include <random>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "imaging/benchmark/picture.hpp"
#include "imaging/settings/configure_locator.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/track/locate_stack.hpp"
#include "tests/support/pictures.hpp"
#include "tests/support/temporary_folder.hpp"

namespace twincell::imaging::flat_field_test {
namespace {

constexpr int kWidth = 260, kHeight = 240;
constexpr double kSnr = 51;

/// Spots of dirt that absorb up to three tenths of the light, some as small as the blur of a rim, and a
/// scratch.
cv::Mat1d grime() {
  cv::Mat1d share(kHeight, kWidth, 1.0);
  std::mt19937 random(4);
  std::uniform_real_distribution<double> unit;
  for (int spot = 0; spot < 120; ++spot) {
    const double x = kWidth * unit(random), y = kHeight * unit(random), size = 0.8 + 2.5 * unit(random),
                 deep = 0.3 * unit(random);
    for (int v = 0; v < kHeight; ++v)
      for (int u = 0; u < kWidth; ++u)
        share(v, u) *= 1 - deep * std::exp(-((u - x) * (u - x) + (v - y) * (v - y)) / (2 * size * size));
  }
  for (int v = 0; v < kHeight; ++v)
    for (int u = 0; u < kWidth; ++u) share(v, u) *= 1 - 0.2 * std::exp(-std::pow(u - 0.7 * v - 40, 2) / 3);
  return share;
}

/// A loose layer that drifts, next to beads that stay in place.
rendered::Picture layer(int frame) {
  rendered::Picture p;
  p.width = kWidth, p.height = kHeight;
  const auto put = [&](double x, double y) {
    rendered::Disc d;
    d.x = x, d.y = y;
    p.discs.push_back(d);
  };
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column < 7; ++column)
      put(20.2 + 22.3 * column + 2.1 * std::sin(5.0 * row + column) + 1.7 * frame,
          16.4 + 22.6 * row + 2.4 * std::sin(3.0 * row + 7.0 * column) - 0.9 * frame + 7);
  for (int row = 0; row < 6; ++row) put(kWidth - 10.3, 20.7 + 33.1 * row);
  return p;
}

struct Stacks {
  explicit Stacks(const TemporaryFolder& folder) : frames(folder / "frames"), blank(folder / "blank") {
    std::filesystem::create_directories(frames);
    std::filesystem::create_directories(blank);
    const cv::Mat1d share = grime();
    const auto write = [&](const rendered::Picture& p, const std::filesystem::path& to, std::uint64_t seed) {
      const cv::Mat1d dirty = (rendered::expected(p) - p.pedestal).mul(share) + p.pedestal;
      write_picture(to.string() + ".png", rendered::expose(dirty, p, kSnr, seed));
    };
    for (int f = 0; f < kFrames; ++f)
      write(layer(f), frames / std::to_string(f), static_cast<std::uint64_t>(f) + 1);
    rendered::Picture none = layer(0);
    none.discs.clear();
    for (int f = 0; f < kBlank; ++f)
      write(none, blank / std::to_string(f), static_cast<std::uint64_t>(f) + 1000);
  }
  static constexpr int kFrames = 40, kBlank = 16;
  std::filesystem::path frames, blank;
};

/// rms distance per coordinate from the true position, px, over the beads that are entirely inside the frame,
/// and the number of missed beads.
struct Error {
  double rms = 0;
  int missed = 0;
};
Error error_of(std::unique_ptr<FrameSource> source) {
  LocatorOptions options;
  options.diameter_px = 15;
  double squares = 0;
  int found = 0;
  Error e;
  FramesAhead ahead(*source);
  const LocatorOptions settled = configure_locator(ahead, options).locator;
  locate_stack(ahead, settled, 2, [&](std::int64_t frame, const cv::Mat&, const Located& located) {
    for (const rendered::Disc& d : layer(static_cast<int>(frame)).discs) {
      if (d.x < 9 || d.y < 9 || d.x > kWidth - 10 || d.y > kHeight - 10) continue;
      double nearest = 4;
      for (const Detection& b : located.beads)
        nearest = std::min(nearest, (b.x - d.x) * (b.x - d.x) + (b.y - d.y) * (b.y - d.y));
      if (nearest >= 4) {
        ++e.missed;
        continue;
      }
      squares += nearest;
      ++found;
    }
  });
  e.rms = std::sqrt(squares / (2 * found));
  return e;
}

TEST(FlatField, RemovesStaticDirt) {
  const TemporaryFolder folder;
  const Stacks stacks(folder);
  const auto frames = [&] { return open_frames(stacks.frames); };
  const cv::Mat1f blank = flat_of_blank(*open_frames(stacks.blank));
  const cv::Mat1f own = flat_of_stack(*frames(), *frames());
  const double bound = 0.36 / kSnr;  // picture_fit.hpp
  const Error as_it_is = error_of(frames()), by_blank = error_of(flattened(frames(), blank)),
              by_own = error_of(flattened(frames(), own));
  std::cout << "rms over the bound: " << as_it_is.rms / bound << " as it is, " << by_blank.rms / bound
            << " by a blank stack, " << by_own.rms / bound << " by the stack itself\n";
  EXPECT_GT(as_it_is.rms, 3 * bound);
  EXPECT_LT(by_blank.rms, 1.2 * bound);
  EXPECT_LT(by_own.rms, 1.35 * bound);
  EXPECT_EQ(by_blank.missed, 0);
  EXPECT_EQ(by_own.missed, 0);
  // Beads that stay in place are not dirt.
  for (int row = 0; row < 6; ++row)
    EXPECT_EQ(own(cvRound(20.7 + 33.1 * row), cvRound(kWidth - 10.3)), 1) << row;
}

TEST(FlatField, RefusesWhatCannotBe) {
  const TemporaryFolder folder;
  const Stacks stacks(folder);
  write_picture(folder / "black.png", cv::Mat1b::zeros(kHeight, kWidth));
  EXPECT_THROW(flat_of_blank(*open_frames(folder / "black.png")), InputError);
  const auto other = flattened(open_frames(stacks.frames), cv::Mat1f::ones(10, 10));
  cv::Mat frame;
  EXPECT_THROW(other->next(frame), InputError);
}

}  // namespace
}  // namespace twincell::imaging::flat_field_test
