#pragma once
/// \file
/// Choice among settings by the evidence of the picture (picture_evidence.hpp).

#include <opencv2/core.hpp>
#include <vector>

#include "imaging/locate/locator.hpp"
#include "imaging/settings/found_settings.hpp"

namespace twincell::imaging {

/// Ratio of evidence at which other settings replace the preferred ones.
inline constexpr double kMinAdvantage = 1.25;
/// The same in a crystal, whose gaps resemble each other as much as its discs do.
inline constexpr double kClearlyInCrystal = 1.6;

/// The part of a frame in which settings are tried.
struct ExaminedRegion {
  cv::Mat picture;
  double neighbour_radius_px = 0;  ///< of picture_evidence: the same for all settings that are compared
  double clearly = kMinAdvantage;  ///< of choose()
};

/// Whether the objects located with settings may be discs: rim_variation and rim_shift are at most
/// kMaxRimVariation and kMaxRimShift.
bool is_round(const TriedSettings& tried);

/// Why they are not discs: the measure that is above its limit, and the limit.
std::string roundness_in_words(const TriedSettings& tried);

/// The settings with most evidence among those that explain something but are not round, if none were chosen;
/// null: there are none.
const TriedSettings* not_round(const SettingsChoice& choice);

/// The given options, completed with settings.
LocatorOptions completed(const FoundSettings& settings, LocatorOptions given);

/// Locates the discs of a region with each of the settings and measures the evidence. Settings that agree to
/// 1.5 % of the diameters are tried once.
/// \param candidates the preferred ones first
/// \param threads which do not change the result
/// \returns in the same order
std::vector<TriedSettings> try_settings(const ExaminedRegion& region, const LocatorOptions& given,
                                        const std::vector<FoundSettings>& candidates, int threads);

/// Tries settings as try_settings() does, with all sweeps of their fit.
TriedSettings tried_in_full(const ExaminedRegion& region, const LocatorOptions& given,
                            const FoundSettings& settings);

/// Sorts by evidence and puts the chosen ones first. They are those with the largest evidence, unless the
/// first in the list, which are preferred, suffice: those with as many sizes must have 1.25 times their
/// evidence (or more discs of the same size, each explained at least as well) and at least half of the area
/// of their discs, and those with further sizes must gain the share of three discs. The evidence knows
/// neither that gaps of a crystal are not discs nor which fit is the most accurate; the order of the list
/// does. Settings whose discs are not round (is_round) are never chosen. Each of the others that has more
/// evidence than the chosen ones, or is not round, says why it was not chosen.
/// \param tried the preferred ones first; those without positive evidence are never chosen
/// \param clearly the factor 1.25
/// \returns none chosen if the largest evidence of round discs is below 5 nats a disc, or below half of that
///   of what is not round
SettingsChoice choose(std::vector<TriedSettings> tried, double clearly = kMinAdvantage);

/// Chooses, then fits the region with the chosen settings in full: a fit that was cut short may hold discs
/// that it drops in the end. If the evidence falls by more than a tenth, chooses again.
SettingsChoice confirmed(const ExaminedRegion& region, const LocatorOptions& given,
                         std::vector<TriedSettings> tried);

/// Whether two settings describe the same kind of discs: polarity, model and diameters, to a tenth. With a
/// profile, discs of the same rim are the same.
bool same_discs(const TriedSettings& a, const TriedSettings& b);

/// Whether the choice is narrow: the runner-up has at least 0.9 of the evidence of the chosen settings. The
/// runner-up are the best settings that describe other discs, which differ by one of
/// - the diameter, by more than a tenth, unless as many discs have a common profile, which has no rim;
/// - the number of sizes;
/// - the number of discs, by more than a twentieth, unless they are fewer, of the same size and polarity, and
///   with less evidence.
/// \returns the index of the runner-up in `tried`; 0: the choice is clear, or there is no runner-up
std::size_t narrow_runner_up(const SettingsChoice& choice);

/// The index of the runner-up, whatever its evidence; 0: there is none.
std::size_t runner_up(const SettingsChoice& choice);

}  // namespace twincell::imaging
