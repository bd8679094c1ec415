#include "imaging/find/vote_finder.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <span>

#include "imaging/find/votes.hpp"

namespace twincell::imaging {

namespace {

// Offset of a parabola's maximum from its middle sample.
double parabola_top(float left, float middle, float right) {
  const float curvature = left - 2 * middle + right;
  return curvature < 0 ? static_cast<double>(std::clamp(0.5f * (left - right) / curvature, -0.5f, 0.5f))
                       : 0.0;
}

/// The peaks of the votes, best first.
std::vector<Proposal> peaks(const Prepared& image, const VoteOptions& options, double full_circle,
                            double min_score) {
  std::vector<Proposal> found;
  const auto least = static_cast<float>(min_score * full_circle);
  const auto n = static_cast<std::size_t>(image.darkness.cols + 2 * options.pad);
  std::vector<std::int32_t> room;
  over_smoothed_votes(image.darkness, image.opaque, options, [&](int y, const VoteLines& lines) {
    if (y < 2) return;
    const auto& [above, row, below] = lines;
    for (const std::int32_t x : tops_of_votes(lines, n, least, room))
      found.push_back({x - options.pad + parabola_top(row[x - 1], row[x], row[x + 1]),
                       y - 1 - options.pad + parabola_top(above[x], row[x], below[x]),
                       static_cast<double>(row[x]) / full_circle});
  });
  std::stable_sort(found.begin(), found.end(),
                   [](const Proposal& a, const Proposal& b) { return a.score > b.score; });
  return found;
}

double square(double a) {
  return a * a;
}

/// Non-maximum suppression of a list, best first: a proposal nearer than `distance` to a better one that is
/// kept is dropped. A grid of cells as wide as the distance makes the time linear.
std::vector<Proposal> suppress_near(const std::vector<Proposal>& sorted, double distance, cv::Size size,
                                    int pad) {
  const auto cell_of = [&](double at) { return 1 + static_cast<int>((at + pad + 1) / distance); };
  const int columns = cell_of(size.width + pad) + 2, rows = cell_of(size.height + pad) + 2;
  std::vector<std::vector<Proposal>> cells(static_cast<std::size_t>(columns) *
                                           static_cast<std::size_t>(rows));
  const auto cell = [&](int x, int y) -> std::vector<Proposal>& {
    return cells[static_cast<std::size_t>(y) * static_cast<std::size_t>(columns) +
                 static_cast<std::size_t>(x)];
  };
  std::vector<Proposal> kept;
  for (const Proposal& p : sorted) {
    const int cx = cell_of(p.x), cy = cell_of(p.y);
    bool near_better = false;
    for (int y = cy - 1; y <= cy + 1; ++y)
      for (int x = cx - 1; x <= cx + 1; ++x)
        for (const Proposal& q : cell(x, y))
          near_better = near_better || square(p.x - q.x) + square(p.y - q.y) < square(distance);
    if (near_better) continue;
    kept.push_back(p);
    cell(cx, cy).push_back(p);
  }
  return kept;
}

}  // namespace

std::vector<Proposal> VoteFinder::find(const Prepared& image, const FindOptions& options) {
  const double r = options.radius_px;
  const int pad = static_cast<int>(std::ceil(r)) + 2;
  // With more smoothing, the votes for touching discs of 6 px merged: their peaks were off by a pixel, and
  // the fit did not search for those discs at their true positions.
  const double smoothing = std::min(kVoteSmoothing, r / 3);
  // Peak of a full circle: 2 pi R edge pixels, each with integral 1, meet in a spot with the variance of the
  // smoothing plus about one px^2 of scatter.
  const double full_circle = 2 * std::numbers::pi * r / (2 * std::numbers::pi * (smoothing * smoothing + 1));
  return suppress_near(peaks(image, {r, smoothing, pad}, full_circle, options.min_score),
                       options.apart * 2 * r, image.darkness.size(), pad);
}

double vote_sharpness(const cv::Mat1f& darkness, double radius_px) {
  const int pad = static_cast<int>(std::ceil(radius_px)) + 2;
  const auto n = static_cast<std::size_t>(darkness.cols + 2 * pad);
  double total = 0, squares = 0;
  over_smoothed_votes(darkness, {}, {radius_px, kVoteSmoothing, pad}, [&](int, const VoteLines& lines) {
    for (const float v : std::span(lines[2], n)) {
      total += static_cast<double>(v);
      squares += static_cast<double>(v) * static_cast<double>(v);
    }
  });
  return total > 0 ? squares / total : 0.0;
}

}  // namespace twincell::imaging
