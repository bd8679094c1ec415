#include "imaging/preprocess/wall_regions.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>
#include <vector>

#include "core/median.hpp"
#include "imaging/preprocess/straight_bars.hpp"

namespace twincell::imaging {

namespace {

// The edge of a region lies within a block or two of its coarse picture. There, the region also enters beads
// that touch it. Such bumps are narrower than a bead; the edge of the region is straight over that width. The
// regions are continued beyond the border, as below.
void trim_bumps(cv::Mat1b& regions, const cv::Mat1b& surely_inside, double disc_radius_px) {
  const int half = cvRound(0.6 * disc_radius_px), width = 2 * half + 1;
  cv::Mat1b continued;
  cv::copyMakeBorder(regions, continued, half, half, half, half, cv::BORDER_REPLICATE);
  const auto opened = [&](int rows, int columns) {
    cv::Mat1b result;
    cv::morphologyEx(continued, result, cv::MORPH_OPEN, cv::Mat1b(rows, columns, uchar{1}));
    return cv::Mat1b(result(cv::Rect(half, half, regions.cols, regions.rows)));
  };
  regions &= (opened(1, width) & opened(width, 1)) | surely_inside;
}

/// Includes the blurred edge of regions.
void include_edge(cv::Mat1b& regions) {
  cv::dilate(regions, regions, cv::Mat(), cv::Point(-1, -1), 2);
}

// Morphological opening of the dark region by a disc, through two distance maps, at reduced resolution. The
// opening is a few pixels too large or too small, but only within the dark region. The frame is continued
// beyond its border, so that a thin strip of plate at the bottom of a frame counts as thick. Empty if there
// is no such region.
cv::Mat1b regions_of(const cv::Mat1b& dark_pixels, double disc_radius_px) {
  constexpr double kCoarseRadius = 6;  // of the disc in the coarse picture, px
  const int shrink = std::max(1, static_cast<int>(disc_radius_px / kCoarseRadius));
  const cv::Size size((dark_pixels.cols + shrink - 1) / shrink, (dark_pixels.rows + shrink - 1) / shrink);
  const double reach = disc_radius_px / shrink;
  // Coarse picture: a block is dark only if all of its pixels are, because the gaps between beads are narrow.
  cv::Mat1b dark = dark_pixels;
  if (shrink > 1) {
    dark = cv::Mat1b(size, uchar{255});
    // Local copies: otherwise the compiler assumes that the stores change these numbers and does not
    // vectorise.
    const int columns = dark_pixels.cols, blocks = size.width;
    std::vector<uchar> dark_down(static_cast<std::size_t>(blocks * shrink));
    for (int block = 0; block < size.height; ++block) {
      std::fill(dark_down.begin(), dark_down.end(), uchar{255});
      uchar *all = dark_down.data(), *to = dark[block];
      for (int y = block * shrink; y < std::min(dark_pixels.rows, (block + 1) * shrink); ++y) {
        const uchar* pixel = dark_pixels[y];
        for (int x = 0; x < columns; ++x) all[x] &= pixel[x];
      }
      for (int k = 0; k < shrink; ++k)
        for (int b = 0; b < blocks; ++b) to[b] &= all[b * shrink + k];
    }
  }
  const int pad = cvCeil(2 * reach);
  cv::copyMakeBorder(dark, dark, pad, pad, pad, pad, cv::BORDER_REPLICATE);
  // Corners: the continuation stays dark only if a wall leads into the corner, dark along one of the borders.
  // A bead in the corner must not grow.
  for (const bool right : {false, true})
    for (const bool low : {false, true}) {
      const int x = right ? pad + size.width - 1 : pad, y = low ? pad + size.height - 1 : pad;
      const auto dark_along = [&](cv::Point step) {
        const int far = std::min(pad, (step.x != 0 ? size.width : size.height) - 1);
        for (int k = 0; k <= far; ++k)
          if (dark(cv::Point(x, y) + k * step) == 0) return false;
        return true;
      };
      if (dark_along({right ? -1 : 1, 0}) || dark_along({0, low ? -1 : 1})) continue;
      dark(cv::Rect(right ? x + 1 : 0, low ? y + 1 : 0, pad, pad)).setTo(0);
    }
  if (cv::countNonZero(dark) == static_cast<int>(dark.total())) return {};
  // Quick test: a square inside the disc, however distances are rounded, is much faster to search for, and
  // most frames do not even contain the square.
  constexpr double kHalfSide = 0.65;  // of the square, radii of the disc
  const int side = 2 * static_cast<int>(kHalfSide * reach) + 1;
  cv::Mat1b squares;
  cv::erode(dark, squares, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  if (cv::countNonZero(squares) == 0) return {};
  // Opening: erosion and dilation by thresholds on distance maps.
  cv::Mat1f inside;
  cv::distanceTransform(dark, inside, cv::DIST_L2, cv::DIST_MASK_5);
  const cv::Mat1b core = inside > reach;
  if (cv::countNonZero(core) == 0) return {};
  cv::Mat1f to_core;
  cv::distanceTransform(~core, to_core, cv::DIST_L2, cv::DIST_MASK_5);
  const cv::Mat1f distance = to_core(cv::Rect(pad, pad, size.width, size.height));
  const auto at_full_size = [&](const cv::Mat1b& blocks) {
    cv::Mat1b full;
    cv::resize(blocks, full, cv::Size(), shrink, shrink, cv::INTER_NEAREST);
    return cv::Mat1b(full(cv::Rect(0, 0, dark_pixels.cols, dark_pixels.rows)));
  };
  cv::Mat1b regions = at_full_size(distance < reach + (shrink > 1 ? 1 : 0)) & dark_pixels;
  trim_bumps(regions, at_full_size(distance < 0.5 * reach), disc_radius_px);
  include_edge(regions);
  return regions;
}

/// Levels of pixels spread over the picture.
std::vector<float> sampled_levels(const cv::Mat1f& darkness) {
  constexpr double kSamples = 20000;
  const int stride =
      std::max(1, static_cast<int>(std::sqrt(static_cast<double>(darkness.total()) / kSamples)));
  std::vector<float> levels;
  for (int y = stride / 2; y < darkness.rows; y += stride)
    for (int x = stride / 2; x < darkness.cols; x += stride) levels.push_back(darkness(y, x));
  return levels;
}

/// The darkness above which thick regions are walls: 0.75, or 0.75 of the darkest level if nothing is as dark
/// as that, as with red walls and beads in grey levels. Below kMinDarkestLevel the contrast is measured
/// instead (PreprocessOptions::contrast). A share of the darkest level in every picture would take blurred
/// crystals for walls.
float least_wall_darkness(std::vector<float> levels) {
  constexpr float kWallDarkness = 0.75F;
  constexpr float kEvenness = 0.93F;        // level of a wall, fraction of its darkest level
  constexpr float kMinDarkestLevel = 0.5F;  // darkness
  constexpr double kDarkestShare = 0.02;    // of the pixels
  if (levels.empty()) return kWallDarkness;
  const auto at =
      levels.end() - 1 - static_cast<std::ptrdiff_t>(kDarkestShare * static_cast<double>(levels.size()));
  std::nth_element(levels.begin(), at, levels.end());
  return *at > kMinDarkestLevel && kEvenness * *at < kWallDarkness ? kWallDarkness * *at : kWallDarkness;
}

/// Pixels darker than a limit. Where the noise makes single pixels of a dark region lighter than that, they
/// count too: the mean of the nine pixels about such a pixel is above the limit, and the pixel is as dark as
/// the noise allows. A gap between beads is lighter, or lightens the mean.
cv::Mat1b pixels_darker_than(float limit, const cv::Mat1f& darkness, std::vector<float> levels) {
  constexpr double kMaxDeviation = 6;  // of a dark pixel, standard deviations of the noise
  cv::Mat1b dark = darkness > limit;
  std::erase_if(levels, [&](float level) { return level <= limit; });
  if (levels.empty()) return dark;
  const auto least = static_cast<float>(static_cast<double>(upper_median(std::move(levels))) -
                                        kMaxDeviation * std::sqrt(noise_of(darkness).dark));
  if (least >= limit) return dark;
  cv::Mat1f mean;
  cv::boxFilter(darkness, mean, CV_32F, {3, 3}, cv::Point(-1, -1), true,
                cv::BORDER_REFLECT_101 | cv::BORDER_ISOLATED);
  dark |= (mean > limit) & (darkness > least);
  return dark;
}

/// Thick regions as dark as walls.
cv::Mat1b regions_as_dark_as_walls(const cv::Mat1f& darkness, double disc_radius_px) {
  const std::vector<float> levels = sampled_levels(darkness);
  return regions_of(pixels_darker_than(least_wall_darkness(levels), darkness, levels), disc_radius_px);
}

/// Thick regions of an even grey between the light and the darkest parts, such as walls of aluminium behind
/// black beads. Even interiors of beads are no larger than the beads.
cv::Mat1b even_grey_regions(const cv::Mat1f& darkness, double radius_px, double in_radii) {
  constexpr float kPalest = 0.2F, kDarkest = 0.8F;         // darkness
  constexpr float kMaxDeviation = 2.5F, kRipple = 0.012F;  // of the noise; of the light on a wall
  const cv::Size size = darkness.size();
  const Noise camera = noise_of(darkness);
  const auto noise =
      static_cast<float>(std::sqrt(camera.dark + camera.light * (1 - static_cast<double>(kPalest))));
  // Quick test, which most frames fail: a square of grey blocks with a small range of levels each.
  constexpr float kMaxRange = 8;  // of the noise
  const int block = std::max(2, cvRound(radius_px / 3));
  const cv::Size blocks(size.width / block, size.height / block);
  if (blocks.empty()) return {};
  cv::Mat1b even(blocks, uchar{0});
  for (int v = 0; v < blocks.height; ++v)
    for (int u = 0; u < blocks.width; ++u) {
      const auto is_grey = [](float level) { return level > kPalest && level < kDarkest; };
      // Most blocks are in the light or in a bead.
      if (!is_grey(darkness(v * block, u * block)) ||
          !is_grey(darkness((v + 1) * block - 1, (u + 1) * block - 1)))
        continue;
      float least = HUGE_VALF, most = -HUGE_VALF;
      for (int y = v * block; y < (v + 1) * block; ++y) {
        const float* row = darkness[y] + u * block;
        for (int x = 0; x < block; ++x) least = std::min(least, row[x]), most = std::max(most, row[x]);
      }
      if (least > kPalest && most < kDarkest && most - least < kMaxRange * noise + 2 * kRipple)
        even(v, u) = 255;
    }
  const int side = std::max(1, static_cast<int>(std::sqrt(2.0) * in_radii * radius_px / block) - 1);
  cv::Mat1b squares;
  cv::erode(even, squares, cv::getStructuringElement(cv::MORPH_RECT, {side, side}));
  if (cv::countNonZero(squares) == 0) return {};
  cv::Mat1f mean, square;
  constexpr int kWindow = 5;
  const auto border = cv::BORDER_REFLECT_101 | cv::BORDER_ISOLATED;
  cv::boxFilter(darkness, mean, CV_32F, {kWindow, kWindow}, cv::Point(-1, -1), true, border);
  const cv::Mat1f squared = darkness.mul(darkness);
  cv::boxFilter(squared, square, CV_32F, {kWindow, kWindow}, cv::Point(-1, -1), true, border);
  const float deviation = kMaxDeviation * noise + kRipple;
  const cv::Mat1b flat =
      (square - mean.mul(mean) < deviation * deviation) & (mean > kPalest) & (mean < kDarkest);
  return regions_of(flat, in_radii * radius_px);
}

/// Gaussian blur that does not reach into the spare columns beside the picture.
void blurred(const cv::Mat1f& picture, double by, cv::Mat1f& out) {
  cv::GaussianBlur(picture, out, {0, 0}, by, by, cv::BORDER_DEFAULT | cv::BORDER_ISOLATED);
}

/// Divides the picture by the level of its dark parts, a quadratic surface. Beyond the levels of these parts
/// nothing is extrapolated. \returns the range of the level, relative to its largest value
/// \param radius_px of beads, whose gaps do not lower the level
double divide_by_level(cv::Mat1f& picture, double radius_px) {
  constexpr int kPasses = 4;
  constexpr float kMinDarkness = 0.4F;
  // Of walls and beads, as fractions of the level.
  constexpr double kMinRelativeLevel = 0.85, kMaxRelativeLevel = 1.1;
  constexpr double kRidge = 1e-3;  // fraction of the number of samples
  constexpr double kSamples = 5000;
  const int stride =
      std::max(1, static_cast<int>(std::sqrt(static_cast<double>(picture.total()) / kSamples)));
  const int wide = 2 * cvCeil(radius_px / 2) + 1;
  cv::Mat1f highest;
  cv::dilate(picture, highest, cv::getStructuringElement(cv::MORPH_RECT, {wide, wide}));
  std::vector<std::pair<Surface, double>> samples;
  for (int y = stride / 2; y < picture.rows; y += stride)
    for (int x = stride / 2; x < picture.cols; x += stride)
      if (picture(y, x) > kMinDarkness)
        samples.emplace_back(surface_basis(x, y, picture.size()), static_cast<double>(highest(y, x)));
  constexpr std::size_t kMinSamples = 60;
  if (samples.size() < kMinSamples) return 0;
  Surface level = Surface::Zero();
  for (int pass = 0; pass < kPasses; ++pass) {
    Eigen::Matrix<double, 6, 6> normal = Eigen::Matrix<double, 6, 6>::Zero();
    Surface right = Surface::Zero();
    for (const auto& [basis, value] : samples) {
      const double expected = level.dot(basis);
      if (pass > 0 && (value < kMinRelativeLevel * expected || value > kMaxRelativeLevel * expected))
        continue;
      normal += basis * basis.transpose();
      right += value * basis;
    }
    normal.diagonal().tail<5>().array() += kRidge * static_cast<double>(samples.size());
    level = normal.ldlt().solve(right);
  }
  std::vector<float> levels;
  for (const auto& [basis, value] : samples) levels.push_back(static_cast<float>(level.dot(basis)));
  const auto [least, most] = std::minmax_element(levels.begin(), levels.end());
  const float low = *least, high = *most;
  if (!(low > 0)) return 0;
  for (int y = 0; y < picture.rows; ++y) {
    const SurfaceRow row = surface_row(level, y, picture.size());
    for (int x = 0; x < picture.cols; ++x) picture(y, x) /= std::clamp(row.at(x), low, high);
  }
  return static_cast<double>((high - low) / high);
}

/// Regions of a smooth picture that are nearly as dark as its darkest parts.
/// \param among the parts \param share of the darkest level
cv::Mat1b regions_near_darkest(const cv::Mat1f& smooth, const cv::Mat1b& among, float share,
                               double disc_radius_px) {
  constexpr double kDarkestQuantile = 0.9;  // a few pixels may be darker
  std::vector<float> levels;
  for (int y = 0; y < smooth.rows; ++y)
    for (int x = 0; x < smooth.cols; ++x)
      if (among(y, x) != 0) levels.push_back(smooth(y, x));
  if (levels.empty()) return {};
  const auto at =
      levels.begin() + static_cast<std::ptrdiff_t>(kDarkestQuantile * static_cast<double>(levels.size()));
  std::nth_element(levels.begin(), at, levels.end());
  return regions_of(smooth > share * *at, disc_radius_px);
}

/// Removes the regions that do not touch the border of the picture.
void keep_at_border(cv::Mat1b& regions) {
  cv::Mat1i part;
  const int n = cv::connectedComponents(regions, part, 8, CV_32S);
  std::vector<uchar> keep(static_cast<std::size_t>(n), uchar{0});
  for (int y = 0; y < part.rows; ++y)
    for (int x = 0; x < part.cols; x += y == 0 || y + 1 == part.rows ? 1 : std::max(1, part.cols - 1))
      keep[static_cast<std::size_t>(part(y, x))] = 255;
  for (int y = 0; y < part.rows; ++y)
    for (int x = 0; x < part.cols; ++x) regions(y, x) &= keep[static_cast<std::size_t>(part(y, x))];
}

/// Darkness relative to the mean of the light where it is seen. The surface through the light of the
/// background, which front light shows between the beads only, is not extrapolated to the walls.
cv::Mat1f against_mean_light(const Prepared& image) {
  constexpr float kMaxBackgroundDarkness = 0.15F;
  const cv::Size size = image.darkness.size();
  double sum = 0, n = 0;
  for (int y = 0; y < size.height; ++y) {
    const SurfaceRow light = surface_row(image.light, y, size);
    for (int x = 0; x < size.width; ++x)
      if (image.darkness(y, x) < kMaxBackgroundDarkness) sum += static_cast<double>(light.at(x)), ++n;
  }
  cv::Mat1f even = image.darkness.clone();
  if (n == 0) return even;
  const auto mean = static_cast<float>(sum / n), unit = static_cast<float>(image.unit);
  for (int y = 0; y < size.height; ++y) {
    const SurfaceRow light = surface_row(image.light, y, size);
    for (int x = 0; x < size.width; ++x)
      even(y, x) = (1 - (1 - even(y, x) * unit) * light.at(x) / mean) / unit;
  }
  return even;
}

/// The walls of a cell that is lit from the front: a lamp lights their middle more than their corners, and
/// they are as noisy as the beads. Absent where light and noise are even enough for the usual search.
std::optional<cv::Mat1b> unevenly_lit_regions(const Prepared& image, double radius_px, double in_radii) {
  // Of the usual search: range of the level and noise, as fractions of the level.
  constexpr double kMaxUnevenness = 0.1, kMaxNoise = 0.03;
  constexpr double kTargetNoise = 0.01;  // after smoothing, fraction of the level
  constexpr double kMinSmoothing_px = 1, kMaxSmoothing_px = 1.5;
  constexpr float kWallDarkness = 0.75F;
  constexpr float kEvenness = 0.93F;  // level of a wall, fraction of its darkest level
  const cv::Mat1f darkness = against_mean_light(image), in_contrast = darkness / contrast_of(darkness);
  const double noise = std::sqrt(noise_of(in_contrast).dark);
  // Smoothing by s reduces white noise by 2 sqrt(pi) s.
  const double by = std::clamp(noise / (2 * std::sqrt(std::numbers::pi) * kTargetNoise), kMinSmoothing_px,
                               kMaxSmoothing_px);
  cv::Mat1f smooth;
  blurred(in_contrast, by, smooth);
  const double uneven = divide_by_level(smooth, radius_px);
  if (uneven < kMaxUnevenness && noise < kMaxNoise) return std::nullopt;
  cv::Mat1b regions = regions_near_darkest(smooth, smooth > kWallDarkness, kEvenness, in_radii * radius_px);
  // Front light reaches a wall up to the border of the picture; dark regions inside are dense parts of the
  // bed.
  if (!regions.empty()) keep_at_border(regions);
  return regions;
}

}  // namespace

// Out of focus, the edge of a wall darkens its surroundings, the gaps of a crystal are nearly as dark as its
// discs, and a wall is only a little darker than both. A second search with a higher threshold on a smoothed
// picture then replaces the first.
cv::Mat1b wall_regions(const Prepared& image, bool bright, double radius_px, double in_radii) {
  const cv::Mat1f& darkness = image.darkness;
  constexpr float kEvenness = 0.93F;  // level of a wall, fraction of its darkest level
  constexpr double kMaxSharpBlur_px = 1.3, kMaxSharpBlurOfRadius = 0.22;  // the larger counts
  constexpr double kSmoothing_px = 1;

  // Distances from an edge to either side, in units of the blur.
  constexpr double kTail = 2, kFromDark = 0.7, kFromDarkest = 1.55;
  const auto uneven = bright ? unevenly_lit_regions(image, radius_px, in_radii) : std::nullopt;
  cv::Mat1b regions = uneven ? *uneven : regions_as_dark_as_walls(darkness, in_radii * radius_px);
  if (!bright)
    if (const cv::Mat1b grey = even_grey_regions(darkness, radius_px, in_radii); !grey.empty())
      regions = regions.empty() ? grey : cv::Mat1b(regions | grey);
  cv::Mat1b bars = straight_bars(darkness, 2 * radius_px, 2 * in_radii * radius_px);
  if (regions.empty() && bars.empty()) return {};
  const double blur = blur_of(darkness);
  constexpr double kMinRadius = 3;  // blurs; the rims of smaller beads do not bend visibly
  if (radius_px < kMinRadius * blur) bars = {};
  if (regions.empty() && bars.empty()) return {};
  double beside = (kTail + (uneven ? kFromDarkest : kFromDark)) * blur;
  if (!uneven && !regions.empty() && blur > std::max(kMaxSharpBlur_px, kMaxSharpBlurOfRadius * radius_px)) {
    cv::Mat1f smooth;
    blurred(darkness, kSmoothing_px, smooth);
    regions = regions_near_darkest(smooth, regions, kEvenness, in_radii * radius_px);
    beside = (kTail + kFromDarkest) * blur;
  }
  if (!bars.empty()) {
    include_edge(bars);
    regions = regions.empty() ? bars : cv::Mat1b(regions | bars);
  }
  const int wide = 2 * std::max(0, cvCeil(beside) - 2) + 1;
  if (!regions.empty() && wide > 1)
    cv::dilate(regions, regions, cv::getStructuringElement(cv::MORPH_ELLIPSE, {wide, wide}));
  return regions;
}

}  // namespace twincell::imaging
