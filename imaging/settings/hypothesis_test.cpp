#include "imaging/settings/hypothesis_test.hpp"

#include <algorithm>
#include <cmath>
#include <opencv2/imgproc.hpp>
#include <utility>
#include <vector>

#include "core/median.hpp"
#include "imaging/refine/profile_fit.hpp"

namespace twincell::imaging {

double gained(const Detection& b) {
  return -b.radius * b.radius * std::log(std::max(1 - b.score, 1e-6));
}

namespace {

/// Whether most discs are too close to another one for discs of one layer, if all were wider by a factor.
bool overlap(const std::vector<Detection>& beads, double wider = 1) {
  constexpr double kOverlap = 0.85;  // smallest distance of centres, in R_i + R_j
  std::vector<double> nearest;
  for (const Detection& b : beads) {
    double least = HUGE_VAL;
    for (const Detection& o : beads)
      if (&o != &b) {
        const double dx = o.x - b.x, dy = o.y - b.y, reach = o.radius + b.radius;
        least = std::min(least, (dx * dx + dy * dy) / (reach * reach));
      }
    nearest.push_back(std::sqrt(least));
  }
  return !nearest.empty() && upper_median(std::move(nearest)) < kOverlap * wider;
}

/// The measure for plain discs of one size, and the median of their diameters; 0 if there are too few. A sum
/// of areas times scores was tried and failed: discs placed in the gaps between dark ones explain nineteen
/// twentieths of their own rings.
Trial try_plain(const cv::Mat& grey, const LocatorOptions& options) {
  constexpr std::size_t kMinDiscs = 3;
  Trial trial;
  std::vector<double> radii;
  const std::vector<Detection> beads = locate(grey, options).beads;
  if (overlap(beads)) return trial;
  for (const Detection& b : beads) {
    if (b.score < kGoodScore) continue;
    trial.explained += gained(b);
    if (!b.edge) radii.push_back(b.radius);
  }
  if (radii.size() >= kMinDiscs)
    trial.diameter_px = std::clamp(2 * upper_median(std::move(radii)), 3.0, 400.0);
  return trial;
}

}  // namespace

Trial settle_plain(const cv::Mat& grey, const LocatorOptions& given, const Hypothesis& h) {
  constexpr int kTrialSweeps = 3;  // enough to recognise discs; a wrong hypothesis never converges
  constexpr int kRounds = 4;
  constexpr double kClose = 0.01;  // relative change of the diameter at convergence
  LocatorOptions options = given;
  options.refine.sweeps = std::min(options.refine.sweeps, kTrialSweeps);
  options.preprocess.bright = h.bright;
  options.preprocess.contrast = h.contrast;
  options.diameter_px = h.diameter_px;
  Trial trial = try_plain(grey, options);
  for (int round = 1; round < kRounds && given.diameter_px <= 0 && trial.diameter_px > 0; ++round) {
    const double change = trial.diameter_px / options.diameter_px - 1;
    options.diameter_px = trial.diameter_px;
    if (std::abs(change) < kClose) break;
    trial = try_plain(grey, options);
  }
  trial.diameter_px = options.diameter_px;
  return trial;
}

ProfileTrial try_profile(const cv::Mat& grey, LocatorOptions options, const Hypothesis& h) {
  constexpr int kTrialSweeps = 3;
  options.refine.method = kProfileRefiner.word;
  options.refine.sweeps = kTrialSweeps;
  options.rim_radii = false;
  options.preprocess.bright = h.bright;
  options.diameter_px = h.diameter_px;
  ProfileTrial trial;
  const LocatorStages stages = locate_stages(grey, options);
  trial.overlaps =
      overlap(stages.judged.beads, std::max(1.0, 2 * stages.refined.profile.rim() / h.diameter_px));
  if (trial.overlaps) return trial;
  for (const Detection& b : stages.judged.beads) trial.explained += gained(b);
  trial.profile = stages.refined.profile;
  return trial;
}

bool ProfileTrial::has_plain_shape() const {
  constexpr double kMaxDifference = 0.012;  // largest DiscProfile::difference_from_plain of a plain disc
  return explained > 0 && profile.difference_from_plain() < kMaxDifference;
}

bool ProfileTrial::looks_plain() const {
  constexpr double kDark = 0.5;  // the plain fit rejects paler discs
  return has_plain_shape() && profile.largest() > kDark;
}

cv::Mat busiest(const cv::Mat& grey, int side) {
  constexpr int kBlock = 16;
  const cv::Size size(std::min(grey.cols, side), std::min(grey.rows, side));
  if (size == grey.size()) return grey;
  cv::Mat1f levels;
  grey.convertTo(levels, CV_32F);
  // A strip thinner than a block is extended to one block.
  cv::copyMakeBorder(levels, levels, 0, std::max(0, kBlock - grey.rows), 0, std::max(0, kBlock - grey.cols),
                     cv::BORDER_REPLICATE);
  cv::Mat1f across, down, blocks;
  cv::Sobel(levels, across, CV_32F, 1, 0);
  cv::Sobel(levels, down, CV_32F, 0, 1);
  cv::resize(cv::abs(across) + cv::abs(down), blocks, {}, 1.0 / kBlock, 1.0 / kBlock, cv::INTER_AREA);
  cv::Mat1d sums;
  cv::integral(blocks, sums, CV_64F);
  const int wide = std::min(blocks.cols, std::max(1, size.width / kBlock)),
            high = std::min(blocks.rows, std::max(1, size.height / kBlock));
  double most = -1;
  cv::Point best;
  for (int y = 0; y + high < sums.rows; ++y)
    for (int x = 0; x + wide < sums.cols; ++x) {
      const double sum = sums(y + high, x + wide) - sums(y, x + wide) - sums(y + high, x) + sums(y, x);
      if (sum > most) most = sum, best = {x, y};
    }
  best = {std::min(kBlock * best.x, grey.cols - size.width),
          std::min(kBlock * best.y, grey.rows - size.height)};
  return grey(cv::Rect(best, size)).clone();
}

}  // namespace twincell::imaging
