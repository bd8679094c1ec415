#include "imaging/settings/polydisperse_settings.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/median.hpp"
#include "imaging/refine/profile_fit.hpp"

namespace twincell::imaging {

namespace {

constexpr double kMinRatio = 1.12, kMaxRatio = 2.5;              // smallest and largest ratio of two sizes
constexpr double kSmallestDiameter = 3, kLargestDiameter = 400;  // px

/// Result of a trial with discs of several sizes.
struct Mix {
  double explained = 0;
  std::vector<double> diameters;
  double least_share = 0;  // fraction of the discs that have the rarest size
  double score = 0;        // median
  std::size_t beads = 0, left_out = 0;
  std::vector<double> of_wrong_radius;  // diameters, of good discs
};

Mix try_sizes(const cv::Mat& grey, const LocatorOptions& given, bool bright, double contrast,
              const std::vector<double>& diameters) {
  constexpr int kTrialSweeps = 4;  // enough to recognise discs
  LocatorOptions options = given;
  options.refine.sweeps = std::min(options.refine.sweeps, kTrialSweeps);
  options.preprocess.bright = bright;
  options.preprocess.contrast = contrast;
  options.diameter_px = diameters.front();
  options.other_diameters_px.assign(diameters.begin() + 1, diameters.end());
  const Located located = locate(grey, options);
  Mix mix;
  std::vector<std::vector<double>> radii(diameters.size());
  std::vector<double> scores;
  for (const Detection& b : located.beads) {
    scores.push_back(b.score);
    if (b.score < kGoodScore) continue;
    mix.explained += gained(b);
    std::size_t nearest = 0;
    for (std::size_t k = 1; k < diameters.size(); ++k)
      if (std::abs(std::log(2 * b.radius / diameters[k])) <
          std::abs(std::log(2 * b.radius / diameters[nearest])))
        nearest = k;
    if (!b.edge) radii[nearest].push_back(b.radius);
  }
  for (const Detection& b : located.dropped) {
    mix.left_out += b.verdict != Verdict::outside && b.verdict != Verdict::in_wall ? 1 : 0;
    if (b.verdict == Verdict::wrong_radius && b.score > kGoodScore)
      mix.of_wrong_radius.push_back(2 * b.radius);
  }
  mix.beads = located.beads.size();
  mix.score = scores.empty() ? 0 : upper_median(scores);
  mix.least_share = 1;
  for (std::size_t k = 0; k < diameters.size(); ++k) {
    mix.least_share = std::min(mix.least_share, static_cast<double>(radii[k].size()) /
                                                    std::max(1.0, static_cast<double>(located.beads.size())));
    mix.diameters.push_back(radii[k].empty() ? diameters[k]
                                             : std::clamp(2 * upper_median(std::move(radii[k])),
                                                          kSmallestDiameter, kLargestDiameter));
  }
  return mix;
}

/// Repeats the trial with the median sizes of the discs found, until the sizes converge.
Mix settle(const cv::Mat& grey, const LocatorOptions& given, bool bright, double contrast,
           std::vector<double> diameters) {
  constexpr int kRounds = 3;
  constexpr double kClose = 0.01;
  Mix best = try_sizes(grey, given, bright, contrast, diameters);
  for (int round = 1; round < kRounds; ++round) {
    double change = 0;
    for (std::size_t k = 0; k < diameters.size(); ++k)
      change = std::max(change, std::abs(best.diameters[k] / diameters[k] - 1));
    if (change < kClose) break;
    diameters = best.diameters;
    best = try_sizes(grey, given, bright, contrast, diameters);
  }
  return best;
}

}  // namespace

bool sizes_apart(const std::vector<double>& diameters, double other) {
  return std::all_of(diameters.begin(), diameters.end(), [&](double d) {
    const double ratio = std::max(d / other, other / d);
    return ratio > kMinRatio && ratio < kMaxRatio;
  });
}

std::optional<FoundSettings> find_polydisperse(const cv::Mat& grey, const LocatorOptions& given,
                                               const std::vector<Hypothesis>& all, const FoundSettings& one) {
  constexpr std::size_t kMaxSizes = 3, kMinDiscs = 3;
  constexpr double kMinShareOfBeads = 0.02;
  constexpr double kBetter = 1.02, kWellExplained = 0.9;
  Mix known = try_sizes(grey, given, one.bright, one.contrast, {one.diameter_px});
  if (one.method == kProfileRefiner.word)
    known.explained =
        std::max(known.explained, try_profile(grey, given, {one.bright, one.diameter_px}).explained);
  while (known.diameters.size() < kMaxSizes) {
    // Candidates for a further size.
    std::vector<double> candidates;
    for (const Hypothesis& h : all)
      if (h.bright == one.bright) candidates.push_back(h.diameter_px);
    if (known.of_wrong_radius.size() >= kMinDiscs) candidates.push_back(upper_median(known.of_wrong_radius));
    // Fixed ratios, because the rims of two sizes may vote more sharply for a third one.
    if (static_cast<double>(known.left_out) > kMinShareOfBeads * static_cast<double>(known.beads))
      for (const double ratio : {0.5, 0.62, 0.76, 1.32, 1.6, 2.0})
        candidates.push_back(ratio * one.diameter_px);
    // Best candidate that explains clearly more.
    std::optional<Mix> better;
    for (const double d : candidates) {
      if (d < 2 * kSmallestRadius || d > kLargestDiameter || !sizes_apart(known.diameters, d)) continue;
      std::vector<double> more = known.diameters;
      more.push_back(d);
      Mix mix = settle(grey, given, one.bright, one.contrast, more);
      if (mix.least_share < kMinShareOfBeads || mix.score < kWellExplained ||
          mix.explained < kBetter * known.explained)
        continue;
      if (!better || mix.explained > better->explained) better = std::move(mix);
    }
    if (!better) break;
    known = std::move(*better);
  }
  if (known.diameters.size() == 1) return std::nullopt;
  std::sort(known.diameters.begin(), known.diameters.end());
  return FoundSettings{known.diameters.front(),
                       one.bright,
                       known.explained,
                       {known.diameters.begin() + 1, known.diameters.end()},
                       {},
                       one.contrast};
}

}  // namespace twincell::imaging
