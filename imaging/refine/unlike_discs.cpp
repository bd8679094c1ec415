#include "imaging/refine/unlike_discs.hpp"

#include <algorithm>
#include <utility>

#include "core/median.hpp"
#include "imaging/refine/picture_evidence.hpp"

namespace twincell {

bool some_may_be_unlike(const std::vector<Detection>& beads) {
  constexpr double kLeast = 0.02, kTimes = 3;
  if (beads.empty()) return false;
  std::vector<double> lacks;
  for (const Detection& b : beads) lacks.push_back(1 - b.score);
  const double limit = kLeast + kTimes * upper_median(lacks);
  return std::any_of(lacks.begin(), lacks.end(), [&](double lack) { return lack > limit; });
}

std::vector<Detection> drop_unlike(const cv::Mat& grey, std::vector<Detection>& beads,
                                   const std::vector<double>& radii_px) {
  constexpr double kLeastMisfit = 1.2;  // smaller ones are those of beads, however little of their rims shows
  const PictureEvidence evidence = picture_evidence(grey, beads, radii_px);
  std::vector<Detection> kept, dropped;
  for (std::size_t k = 0; k < beads.size(); ++k) {
    const bool unlike = evidence.of_disc[k] < 0 && evidence.misfit[k] > kLeastMisfit;
    (unlike ? dropped : kept).push_back(beads[k]);
    if (unlike) dropped.back().verdict = Verdict::unexplained;
  }
  beads = std::move(kept);
  return dropped;
}

}  // namespace twincell
