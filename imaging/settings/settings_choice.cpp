#include "imaging/settings/settings_choice.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "core/in_parallel.hpp"
#include "imaging/refine/overlapping_fit.hpp"
#include "imaging/refine/picture_evidence.hpp"
#include "imaging/refine/profile_fit.hpp"
#include "imaging/refine/rim_shift.hpp"
#include "imaging/refine/rim_variation.hpp"
#include "imaging/settings/find_contrast.hpp"
#include "imaging/settings/hypothesis_test.hpp"

namespace twincell::imaging {

namespace {

constexpr double kOtherSize = 0.1;  // relative difference of diameters

/// All diameters, ascending.
std::vector<double> diameters_of(const FoundSettings& s) {
  std::vector<double> all = s.other_diameters_px;
  all.push_back(s.diameter_px);
  std::sort(all.begin(), all.end());
  return all;
}

bool same_sizes(const FoundSettings& a, const FoundSettings& b, double tolerance) {
  const std::vector<double> of_a = diameters_of(a), of_b = diameters_of(b);
  return of_a.size() == of_b.size() &&
         std::equal(of_a.begin(), of_a.end(), of_b.begin(),
                    [&](double x, double y) { return std::abs(x / y - 1) < tolerance; });
}

/// Whether all sizes of `some`, and others, are sizes of `all`.
bool has_sizes_of(const FoundSettings& all, const FoundSettings& some) {
  const std::vector<double> sizes = diameters_of(all), fewer = diameters_of(some);
  return fewer.size() < sizes.size() && std::all_of(fewer.begin(), fewer.end(), [&](double d) {
           return std::any_of(sizes.begin(), sizes.end(),
                              [&](double s) { return std::abs(s / d - 1) < kOtherSize; });
         });
}

bool is_profile(const TriedSettings& tried) {
  return tried.settings.method == kProfileRefiner.word;
}

bool is_overlapping(const TriedSettings& tried) {
  return tried.settings.method == kOverlappingRefiner.word;
}

bool agree(const FoundSettings& a, const FoundSettings& b) {
  constexpr double kSame = 0.015;
  return a.bright == b.bright && a.method == b.method && a.contrast == b.contrast && same_sizes(a, b, kSame);
}

/// Area of the discs, if all are of the first size, px^2 up to a factor.
double area_of(const TriedSettings& tried) {
  return static_cast<double>(tried.beads) * tried.settings.diameter_px * tried.settings.diameter_px;
}

/// Whether `other` explains more discs of the same size than `first`, and each at least as well: then `first`
/// loses discs, as plain ones with bright spots.
bool finds_more_of_the_same(const TriedSettings& other, const TriedSettings& first) {
  constexpr double kMore = 1.05, kSameSize = 0.1;
  return other.settings.bright == first.settings.bright &&
         same_sizes(other.settings, first.settings, kSameSize) &&
         static_cast<double>(other.beads) > kMore * static_cast<double>(first.beads) &&
         other.evidence * static_cast<double>(first.beads) >
             first.evidence * static_cast<double>(other.beads);
}

/// Whether the discs of `first` are parts of those of `other`, such as the reflections of steel balls: as
/// many discs of the same polarity, and clearly smaller.
bool are_parts(const TriedSettings& first, const TriedSettings& other) {
  constexpr double kSmaller = 1.3, kAsMany = 0.05;
  const double more =
      static_cast<double>(other.beads) / static_cast<double>(std::max<std::size_t>(1, first.beads));
  return other.settings.bright == first.settings.bright && std::abs(more - 1) < kAsMany &&
         first.settings.other_diameters_px.empty() && other.settings.other_diameters_px.empty() &&
         other.rim_px > kSmaller * first.rim_px;
}

/// Whether `other` shows more of the discs of `first`: wider ones with a common profile, of the same polarity
/// and not more of them. Then `first` may be their highlights, with spots between them.
bool shows_more_of(const TriedSettings& first, const TriedSettings& other) {
  constexpr double kWider = 1.2, kFewest = 0.5, kMost = 1.05;  // of the number of discs
  const double share =
      static_cast<double>(other.beads) / static_cast<double>(std::max<std::size_t>(1, first.beads));
  return is_profile(other) && other.settings.bright && first.settings.bright &&
         first.settings.other_diameters_px.empty() && share > kFewest && share < kMost &&
         other.settings.diameter_px > kWider * first.settings.diameter_px;
}

/// The rejected candidates that are discs, of another size or outside the frame.
std::vector<Detection> other_discs(const std::vector<Detection>& dropped) {
  std::vector<Detection> discs;
  for (const Detection& d : dropped)
    if ((d.verdict == Verdict::wrong_radius || d.verdict == Verdict::outside) && d.score > kGoodScore)
      discs.push_back(d);
  return discs;
}

TriedSettings try_one(const ExaminedRegion& region, const LocatorOptions& given, FoundSettings settings,
                      int most_sweeps) {
  LocatorOptions options = completed(settings, given);
  if (model_of(options.refine) == DiscModel::circle)
    settings.contrast = options.preprocess.contrast = find_contrast(region.picture, options);
  options.refine.sweeps = std::min(options.refine.sweeps, most_sweeps);
  options.rim_radii = false;
  const LocatedBetweenWalls found = locate_between_walls(region.picture, options);
  const cv::Mat1b& walls = found.walls;
  const std::vector<Detection>& beads = found.located.beads;
  const std::vector<double> radii = options.radii_px();
  const PictureEvidence evidence =
      picture_evidence(region.picture, beads, radii, region.neighbour_radius_px, walls);
  TriedSettings tried{settings, evidence.total, beads.size(), found.located.rim * settings.diameter_px};
  // A stated size is that of round objects. Rims of patterned discs vary with direction.
  if (given.diameter_px <= 0 && model_of(options.refine) != DiscModel::circle) {
    tried.rim_variation =
        rim_variation(region.picture, beads, radii, other_discs(found.located.dropped), walls);
    tried.rim_shift = rim_shift(beads, evidence.rims, radii);
  }
  return tried;
}

constexpr double kMinShare = 5;  // nats a disc: odds of 150 that it is one
constexpr double kPart = 0.5;    // least evidence, in that of what is not round

bool explains(const TriedSettings& tried) {
  return tried.evidence > 0 && tried.evidence >= kMinShare * static_cast<double>(tried.beads);
}

bool less(const TriedSettings& a, const TriedSettings& b) {
  return a.evidence < b.evidence;
}

/// None chosen: what explains something but is not round first, each by evidence.
SettingsChoice refuse(std::vector<TriedSettings> tried) {
  for (TriedSettings& t : tried)
    if (!explains(t))
      t.not_chosen = fmt::format("less than {:g} nats a bead", kMinShare);
    else if (is_round(t))
      t.not_chosen = fmt::format("less than {:g} of the evidence of what is not round", kPart);
  const auto others = std::stable_partition(tried.begin(), tried.end(),
                                            [](const auto& t) { return explains(t) && !is_round(t); });
  const auto more = [](const auto& a, const auto& b) { return less(b, a); };
  std::stable_sort(tried.begin(), others, more);
  std::stable_sort(others, tried.end(), more);
  return {{}, std::move(tried)};
}

}  // namespace

std::string roundness_in_words(const TriedSettings& tried) {
  return tried.rim_variation > kMaxRimVariation
             ? fmt::format(
                   "levels at the rims vary by {:.2f} with the direction, those of beads by at most {:g}",
                   tried.rim_variation, kMaxRimVariation)
             : fmt::format("rims deviate from circles by {:.3f} radii, those of beads by at most {:g}",
                           tried.rim_shift, kMaxRimShift);
}

bool is_round(const TriedSettings& tried) {
  return tried.rim_variation <= kMaxRimVariation && tried.rim_shift <= kMaxRimShift;
}

const TriedSettings* not_round(const SettingsChoice& choice) {
  if (choice.refused.empty()) return nullptr;
  const TriedSettings& first = choice.refused.front();
  return explains(first) && !is_round(first) ? &first : nullptr;
}

LocatorOptions completed(const FoundSettings& settings, LocatorOptions given) {
  given.judge.drop_outliers = given.diameter_px <= 0 && settings.other_diameters_px.empty();
  given.diameter_px = settings.diameter_px;
  given.preprocess.bright = settings.bright;
  if (given.other_diameters_px.empty()) given.other_diameters_px = settings.other_diameters_px;
  if (!settings.method.empty()) given.refine.method = settings.method;
  given.preprocess.contrast = settings.contrast;
  given.polarity_known = true;
  return given;
}

std::vector<TriedSettings> try_settings(const ExaminedRegion& region, const LocatorOptions& given,
                                        const std::vector<FoundSettings>& candidates, int threads) {
  constexpr int kTrialSweeps = 6;    // enough for most discs to be in place
  std::vector<FoundSettings> known;  // before their contrast is measured
  for (const FoundSettings& c : candidates)
    if (std::none_of(known.begin(), known.end(), [&](const FoundSettings& k) { return agree(k, c); }))
      known.push_back(c);
  std::vector<TriedSettings> tried(known.size());
  in_parallel(known.size(), threads,
              [&](std::size_t k) { tried[k] = try_one(region, given, known[k], kTrialSweeps); });
  return tried;
}

TriedSettings tried_in_full(const ExaminedRegion& region, const LocatorOptions& given,
                            const FoundSettings& settings) {
  return try_one(region, given, settings, given.refine.sweeps);
}

SettingsChoice choose(std::vector<TriedSettings> tried, double min_advantage) {
  constexpr double kDiscs = 3, kTimesArea = 2, kMore = 1.05;
  // Discs that may overlap can explain more, like discs of further sizes.
  const auto sizes = [](const TriedSettings& t) {
    return t.settings.other_diameters_px.size() + (is_overlapping(t) ? 1 : 0);
  };
  for (TriedSettings& t : tried) t.not_chosen = is_round(t) ? "" : "not round: " + roundness_in_words(t);
  // Preferred ones first, then those that are not round.
  const auto end = std::stable_partition(tried.begin(), tried.end(), is_round);
  const auto best = std::max_element(tried.begin(), end, less);
  // Parts of larger objects may be round.
  if (best == end || !explains(*best) || std::any_of(end, tried.end(), [&](const TriedSettings& t) {
        return explains(t) && best->evidence < kPart * t.evidence;
      }))
    return refuse(std::move(tried));
  const double share = best->evidence / static_cast<double>(best->beads);
  auto chosen = best;
  const auto first = tried.begin();
  std::string reason;
  if (first->evidence > 0 && sizes(*first) <= sizes(*best) && first != best) {
    // Marks on the ground may be discs too, and more of them than there are beads.
    if (sizes(*first) < sizes(*best)) {
      if (first->evidence > best->evidence - kDiscs * share)
        reason = is_overlapping(*best) ? "a further layer gains less than three discs"
                                       : "a further size gains less than three discs";
    } else if ((shows_more_of(*first, *best) ? kMore
                : are_parts(*first, *best)   ? kMinAdvantage
                                             : min_advantage) *
                       first->evidence >
                   best->evidence &&
               !finds_more_of_the_same(*best, *first)) {
      reason = fmt::format("less than {:g} times the evidence of the preferred ones{}", min_advantage,
                           min_advantage > kMinAdvantage
                               ? ", because the gaps of a crystal resemble each other as its discs do"
                               : "");
    } else if (area_of(*first) > kTimesArea * area_of(*best)) {
      reason = "less than half of the area of the preferred ones";
    }
    if (!reason.empty()) chosen = first;
  }
  for (auto t = tried.begin(); t != end; ++t) {
    if (t->evidence > chosen->evidence) t->not_chosen = reason;
    t->preferred = t == first && t != chosen;
  }
  SettingsChoice choice{{*chosen}, {}};
  tried.erase(chosen);
  std::stable_sort(tried.begin(), tried.end(), [&](const auto& a, const auto& b) { return less(b, a); });
  choice.tried.insert(choice.tried.end(), tried.begin(), tried.end());
  return choice;
}

SettingsChoice confirmed(const ExaminedRegion& region, const LocatorOptions& given,
                         std::vector<TriedSettings> tried) {
  SettingsChoice choice = choose(std::move(tried), region.min_advantage);
  // Each failure lowers the evidence of one of the settings to that of its full fit.
  for (std::size_t left = choice.tried.size(); left > 0; --left) {
    TriedSettings& first = choice.tried.front();
    const double before = first.evidence;
    first = tried_in_full(region, given, first.settings);
    constexpr double kKept = 0.9;
    if (first.evidence >= kKept * before && is_round(first)) break;
    choice = choose(std::move(choice.tried), region.min_advantage);
    if (choice.tried.empty()) break;
  }
  return choice;
}

bool same_discs(const TriedSettings& a, const TriedSettings& b) {
  return a.settings.bright == b.settings.bright && a.settings.method == b.settings.method &&
         (same_sizes(a.settings, b.settings, kOtherSize) ||
          (is_profile(a) && std::abs(a.rim_px / b.rim_px - 1) < kOtherSize));
}

std::size_t runner_up(const SettingsChoice& choice) {
  constexpr double kOtherNumber = 0.05, kFew = 0.02;
  for (std::size_t k = 1; k < choice.tried.size(); ++k) {
    const TriedSettings &first = choice.tried.front(), &other = choice.tried[k];
    if (!is_round(other)) continue;
    // Fewer discs of the same size, with less evidence, are some of the chosen ones.
    if (other.beads < first.beads && other.evidence < first.evidence &&
        other.settings.bright == first.settings.bright &&
        same_sizes(first.settings, other.settings, kOtherSize))
      continue;
    // Without the size of a few large discs, the others are the same.
    if (other.beads <= first.beads && other.evidence < first.evidence &&
        other.settings.bright == first.settings.bright && has_sizes_of(first.settings, other.settings) &&
        static_cast<double>(first.beads - other.beads) < kFew * static_cast<double>(first.beads))
      continue;
    const double difference = std::abs(static_cast<double>(other.beads) - static_cast<double>(first.beads));
    if (difference > kOtherNumber * static_cast<double>(first.beads)) return k;
    // A profile has no rim: with another diameter it describes the same discs.
    if (is_profile(other) && !is_profile(first)) continue;
    if (!same_sizes(first.settings, other.settings, kOtherSize)) return k;
  }
  return 0;
}

std::size_t narrow_runner_up(const SettingsChoice& choice) {
  constexpr double kNarrow = 0.9;
  const std::size_t k = runner_up(choice);
  return k > 0 && choice.tried[k].evidence >= kNarrow * choice.tried.front().evidence ? k : 0;
}

}  // namespace twincell::imaging
