#include "imaging/refine/outlier_discs.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/median.hpp"
#include "imaging/refine/picture_evidence.hpp"

namespace twincell::imaging {

namespace {

/// 1 - score of a disc that is not like the others.
double limit_of_lack(const std::vector<Detection>& beads) {
  constexpr double kMargin = 0.01, kMultipleOfMedian = 3;
  std::vector<double> lacks;
  for (const Detection& b : beads) lacks.push_back(1 - b.score);
  return beads.empty() ? 1 : kMargin + kMultipleOfMedian * upper_median(std::move(lacks));
}

}  // namespace

bool may_have_outliers(const std::vector<Detection>& beads) {
  const double limit = limit_of_lack(beads);
  return std::any_of(beads.begin(), beads.end(), [&](const Detection& b) { return 1 - b.score > limit; });
}

namespace {

/// Whether a disc outside the frame was found near a bead: others, which darken its rim, may be missing.
bool near_outside(const Detection& b, const std::vector<Detection>& others) {
  constexpr double kMaxDistance = 5;  // R
  return std::any_of(others.begin(), others.end(), [&](const Detection& o) {
    return o.verdict == Verdict::outside && std::hypot(o.x - b.x, o.y - b.y) < kMaxDistance * b.radius;
  });
}

}  // namespace

std::vector<Detection> drop_outliers(const cv::Mat& grey, std::vector<Detection>& beads,
                                     const std::vector<Detection>& others, double radius_px) {
  constexpr double kMinMisfit = 1.6;  // smaller ones are those of beads, however little of their rims shows
  const double limit = limit_of_lack(beads);
  std::vector<Detection> all = beads;
  for (const Detection& o : others)
    if (o.verdict == Verdict::outside) all.push_back(o);
  const PictureEvidence evidence = picture_evidence(grey, all, {radius_px});
  std::vector<Detection> kept, dropped;
  for (std::size_t k = 0; k < beads.size(); ++k) {
    const bool outlier = 1 - beads[k].score > limit && evidence.of_disc[k] < 0 &&
                         evidence.misfit[k] > kMinMisfit && !near_outside(beads[k], others);
    (outlier ? dropped : kept).push_back(beads[k]);
    if (outlier) dropped.back().verdict = Verdict::unexplained;
  }
  beads = std::move(kept);
  return dropped;
}

}  // namespace twincell::imaging
