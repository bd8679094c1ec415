#include "imaging/refine/missed_discs.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <vector>

#include "imaging/refine/out_of_frame_discs.hpp"

namespace twincell::imaging {

namespace {

// A missed disc has a given size if the residual inside kInner R averages kFilled of the usual darkness.
constexpr double kInner = 0.85, kFilled = 0.7;

/// The strongest evidence first.
void sort_by_score(std::vector<Proposal>& proposals) {
  std::stable_sort(proposals.begin(), proposals.end(),
                   [](const Proposal& a, const Proposal& b) { return a.score > b.score; });
}

/// A frame divided into square blocks of pixels.
struct Blocks {
  int side;  // px
  /// Index of the block, not rounded, at a position in pixels.
  [[nodiscard]] double index(double at) const { return (at + 0.5) / side - 0.5; }
  [[nodiscard]] double middle(int index) const { return side * (index + 0.5) - 0.5; }
};

/// Sums of the residual picture over 3 x 3 blocks, divided by 9.
cv::Mat1f block_residuals(const FrameModel& frame, Blocks grid) {
  const int side = grid.side, width = frame.size.width;
  cv::Mat1f blocks = cv::Mat1f::zeros(frame.size.height / side, width / side);
  std::vector<float> columns(static_cast<std::size_t>(width));
  for (int row = 0; row < blocks.rows; ++row) {
    std::fill(columns.begin(), columns.end(), 0.0F);
    float *left = columns.data(), *block = blocks[row];
    for (int y = row * side; y < (row + 1) * side; ++y) {
      const float *d = frame.picture[y], *t = frame.model[y];
      for (int x = 0; x < width; ++x) left[x] += d[x] < kUnseen ? d[x] - t[x] : 0.0F;
    }
    for (int k = 0; k < side; ++k)
      for (int x = 0; x < blocks.cols; ++x) block[x] += left[x * side + k];
  }
  if (!blocks.empty()) cv::boxFilter(blocks, blocks, CV_32F, {3, 3}, {-1, -1}, false, cv::BORDER_CONSTANT);
  return blocks;
}

/// Blocks dark enough for a disc, the darkest first.
std::vector<Proposal> dark_blocks(const cv::Mat1f& residuals, Blocks grid, double darkness) {
  std::vector<Proposal> dark;
  for (int y = 0; y < residuals.rows; ++y)
    for (int x = 0; x < residuals.cols; ++x)
      if (const double mean = static_cast<double>(residuals(y, x)) / (9 * grid.side * grid.side);
          mean >= darkness)
        dark.push_back({grid.middle(x), grid.middle(y), mean});
  sort_by_score(dark);
  return dark;
}

/// Marks the blocks whose middle lies within R plus 0.3 of the smallest R of a known disc: opaque discs do
/// not overlap. A map, because in noise there are tens of thousands of candidates and of discs.
void mark_known(cv::Mat1b& known, Blocks grid, const FrameModel& frame, const Detection& b) {
  const double reach = frame.priors.nominal_radius(b.radius) + 0.3 * frame.priors.smallest();
  const int last_y = std::min(known.rows - 1, cvFloor(grid.index(b.y + reach))),
            last_x = std::min(known.cols - 1, cvFloor(grid.index(b.x + reach)));
  for (int y = std::max(0, cvCeil(grid.index(b.y - reach))); y <= last_y; ++y)
    for (int x = std::max(0, cvCeil(grid.index(b.x - reach))); x <= last_x; ++x) {
      const double dx = grid.middle(x) - b.x, dy = grid.middle(y) - b.y;
      if (dx * dx + dy * dy < reach * reach) known(y, x) = 1;
    }
}

/// Residual within kInner of a radius: sum, sum of squares, and number of pixels.
struct Residual {
  double left = 0, squares = 0, pixels = 0;
  /// Whether it is about the same everywhere, as inside a pale disc; in dust and in shadows it is not.
  [[nodiscard]] bool is_even() const {
    constexpr double kMaxScatter = 0.3;  // fraction of the mean
    constexpr double kMinPixels = 5;
    if (pixels < kMinPixels || left <= 0) return false;
    const double mean = left / pixels;
    return squares / pixels - mean * mean < kMaxScatter * kMaxScatter * mean * mean;
  }
};

Residual residual_within(const FrameModel& frame, const Proposal& p, double radius) {
  const int reach = cvFloor(radius);
  Residual r;
  for (int y = std::max(0, cvRound(p.y) - reach); y <= std::min(frame.size.height - 1, cvRound(p.y) + reach);
       ++y)
    for (int x = std::max(0, cvRound(p.x) - reach); x <= std::min(frame.size.width - 1, cvRound(p.x) + reach);
         ++x)
      if (std::hypot(x - p.x, y - p.y) < radius && frame.picture(y, x) < kUnseen) {
        const auto left = static_cast<double>(frame.picture(y, x) - frame.model(y, x));
        r.left += left, r.squares += left * left, ++r.pixels;
      }
  return r;
}

/// Whether a pale residual may be a disc: it is even inside, and neither cut by the frame nor next to a wall,
/// whose light leaves such residuals.
bool may_be_pale_disc(const FrameModel& frame, const Proposal& p) {
  constexpr double kEvenRadius = 0.6;   // fraction of R
  constexpr double kMinFreeArea = 0.7;  // fraction of the disc's area
  const double r = p.radius;
  return residual_within(frame, p, kEvenRadius * r).is_even() &&
         residual_within(frame, p, r).pixels > kMinFreeArea * std::numbers::pi * r * r;
}

/// The largest size for which the residual picture is dark at that position; otherwise the smallest size.
double missed_radius(const FrameModel& frame, const Proposal& p) {
  double radius = frame.priors.smallest();
  for (const double size : frame.priors.nominal_radii()) {
    if (size <= radius) continue;
    const Residual r = residual_within(frame, p, kInner * size);
    if (r.left > kFilled * frame.priors.darkness().mean * r.pixels) radius = size;
  }
  return radius;
}

/// Whether a candidate outside the frame is so close to a known disc that it is a misfit of that disc.
bool is_known(const FrameModel& frame, const Proposal& p) {
  return std::any_of(frame.beads.begin(), frame.beads.end(), [&](const Detection& b) {
    const double reach = frame.priors.nominal_radius(b.radius) + 0.5 * frame.priors.smallest();
    return (b.x - p.x) * (b.x - p.x) + (b.y - p.y) * (b.y - p.y) < reach * reach;
  });
}

}  // namespace

bool add_missed(FrameModel& frame, double darkness) {
  if (frame.stale) frame.render();
  const Blocks grid{std::max(1, cvRound(0.4 * frame.priors.smallest()))};
  const cv::Mat1f residuals = block_residuals(frame, grid);
  if (residuals.empty()) return false;
  cv::Mat1b known = cv::Mat1b::zeros(residuals.size());
  for (const Detection& b : frame.beads) mark_known(known, grid, frame, b);
  const std::size_t before = frame.beads.size();
  for (Proposal& p : dark_blocks(residuals, grid, darkness)) {
    if (known(cvRound(grid.index(p.y)), cvRound(grid.index(p.x))) != 0) continue;
    p.radius = missed_radius(frame, p);
    if (p.score < kMissedDarkness && !may_be_pale_disc(frame, p)) continue;
    const std::size_t had = frame.beads.size();
    frame.add(p);
    if (frame.beads.size() > had) mark_known(known, grid, frame, frame.beads.back());
  }
  return frame.beads.size() > before;
}

bool add_out_of_frame(FrameModel& frame, bool blur_known) {
  if (frame.stale) frame.render();
  const double blur = std::sqrt(frame.blur.variance);
  std::vector<Proposal> beyond;
  for (const Prior& s : frame.priors.radii())
    for (Proposal p : out_of_frame_discs(frame.ring_args(), s.mean,
                                         blur_known ? s.mean + blur : s.mean - blur, kMissedDarkness)) {
      p.radius = s.mean;
      beyond.push_back(p);
    }
  sort_by_score(beyond);
  const std::size_t before = frame.beads.size();
  for (const Proposal& p : beyond)
    if (!is_known(frame, p)) frame.add(p);
  return frame.beads.size() > before;
}

}  // namespace twincell::imaging
