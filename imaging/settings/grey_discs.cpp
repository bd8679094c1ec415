#include "imaging/settings/grey_discs.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

#include "core/in_parallel.hpp"
#include "core/median.hpp"
#include "imaging/refine/picture_fit.hpp"
#include "imaging/refine/profile_fit.hpp"
#include "imaging/settings/size_hypotheses.hpp"

namespace twincell::imaging {

namespace {

constexpr Contrasts kPaleContrasts{0, kPale}, kGreyContrasts{kPale, kOpaque};

/// Pale discs of the sizes of hypotheses, each with the median darkness of those that are located. Walls that
/// are darker than the discs hide the contrast of the discs from contrast_of().
std::vector<Hypothesis> pale_among(const cv::Mat& grey, const LocatorOptions& given,
                                   const std::vector<Hypothesis>& sizes) {
  constexpr std::size_t kMinDiscs = 10;
  std::vector<Hypothesis> pale;
  for (Hypothesis h : sizes) {
    LocatorOptions options = given;
    options.diameter_px = h.diameter_px;
    options.preprocess.bright = h.bright;
    options.refine.pale = true;
    std::vector<double> darkness;
    for (const Detection& d : locate(grey, options).beads) darkness.push_back(d.darkness);
    if (darkness.size() < kMinDiscs) continue;
    h.contrast = upper_median(std::move(darkness));
    if (h.contrast < kPale) pale.push_back(h);
  }
  return pale;
}

}  // namespace

PaleDiscs find_pale(const cv::Mat& grey, const LocatorOptions& given, double lattice,
                    std::vector<Hypothesis> sizes, const std::optional<FoundSettings>& best) {
  if (model_of(given.refine) != DiscModel::plain) return {};
  std::vector<Hypothesis> all = size_hypotheses(grey, given, lattice, kPaleContrasts);
  if (all.empty() && best) {
    constexpr double kSameSize = 0.2;  // pale discs are at best found with another model, of about their size
    std::erase_if(sizes, [&](const Hypothesis& h) {
      return h.bright != best->bright || std::abs(h.diameter_px / best->diameter_px - 1) > kSameSize;
    });
    if (sizes.empty()) sizes.push_back({best->bright, best->diameter_px});
    all = pale_among(grey, given, sizes);
  }
  if (all.empty()) return {};
  double to_beat = best ? kPaleClearly * best->explained : 0;
  bool comparable = true;
  if (best && best->method == kProfileRefiner.word) {
    const ProfileTrial trial = try_profile(grey, given, {best->bright, best->diameter_px});
    comparable = trial.explained <= 0 || trial.has_plain_shape();
    to_beat = trial.explained;
  }
  PaleDiscs pale;
  double most = comparable ? to_beat : 0;
  for (const Hypothesis& h : all) {
    const Trial trial = settle_plain(grey, given, h);
    if (trial.explained <= most) continue;
    most = trial.explained;
    pale = {FoundSettings{trial.diameter_px, h.bright, trial.explained, {}, {}, h.contrast}, comparable};
  }
  return pale;
}

std::vector<FoundSettings> find_grey(const cv::Mat& grey, const LocatorOptions& given, double lattice,
                                     int threads) {
  const std::vector<Hypothesis> all = size_hypotheses(grey, given, lattice, kGreyContrasts);
  std::vector<Trial> trials(all.size());
  in_parallel(all.size(), threads, [&](std::size_t k) { trials[k] = settle_plain(grey, given, all[k]); });
  std::vector<FoundSettings> found;
  for (std::size_t k = 0; k < all.size(); ++k)
    if (trials[k].explained > 0)
      found.push_back({trials[k].diameter_px, all[k].bright, trials[k].explained, {}, {}, all[k].contrast});
  return found;
}

}  // namespace twincell::imaging
