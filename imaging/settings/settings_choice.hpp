#pragma once
/// \file
/// Choice among settings by the evidence of the picture (picture_evidence.hpp).

#include <cstddef>
#include <opencv2/core.hpp>
#include <string>
#include <vector>

#include "imaging/locate/locator.hpp"
#include "imaging/settings/found_settings.hpp"

namespace twincell::imaging {

/// Ratio of evidence from which other settings replace the preferred ones.
inline constexpr double kMinAdvantage = 1.25;
/// The same in a crystal, whose gaps resemble each other as much as its discs do.
inline constexpr double kMinAdvantageInCrystal = 1.6;

/// The part of a frame in which settings are tried.
struct ExaminedRegion {
  cv::Mat picture;
  double neighbour_radius_px = 0;        ///< of picture_evidence: the same for all settings that are compared
  double min_advantage = kMinAdvantage;  ///< of choose()
};

/// Whether the objects located with these settings may be discs: rim_variation and rim_shift are at most
/// kMaxRimVariation and kMaxRimShift.
bool is_round(const TriedSettings& tried);

/// Why they are not discs: the measure that exceeds its limit, and the limit.
std::string roundness_in_words(const TriedSettings& tried);

/// If no settings were chosen: those with the most evidence among the settings that explain the picture (5
/// nats a disc or more) with objects that are not round. Null: there are none, or settings were chosen.
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

/// Tries settings as try_settings() does, but with all sweeps of their fit.
TriedSettings tried_in_full(const ExaminedRegion& region, const LocatorOptions& given,
                            const FoundSettings& settings);

/// Sorts settings by evidence and puts the chosen ones first. The settings with the largest evidence are
/// chosen unless the first in the list, the preferred ones, suffice. Settings with as many sizes as the
/// preferred ones replace them if
///
/// - they have min_advantage times the evidence of the preferred ones, or find over 5 % more discs of the
///   same size and explain each at least as well;
/// - their discs cover at least half of the area of the preferred ones.
///
/// Where the preferred discs may be parts of the other ones, smaller ratios suffice: 1.25 for as many,
/// clearly larger discs, 1.05 for wider bright discs with a common profile. Settings with more sizes replace
/// the preferred ones if their evidence is larger by that of three discs. The evidence contains neither that
/// gaps of a crystal are not discs nor which fit is the most accurate; the order of the list does. Settings
/// whose discs are not round (is_round) are never chosen. All settings that are not round, or have more
/// evidence than the chosen ones, state why they were not chosen.
///
/// \param tried the preferred ones first; those without positive evidence are never chosen
/// \returns none chosen if the largest evidence of round discs is below 5 nats a disc, or below half of that
///   of objects that are not round
SettingsChoice choose(std::vector<TriedSettings> tried, double min_advantage = kMinAdvantage);

/// Chooses, then fits the region with all sweeps of the chosen settings: a fit that ended early may contain
/// discs that the complete fit drops. If the evidence falls by more than a tenth, or the discs are not round,
/// chooses again.
SettingsChoice confirmed(const ExaminedRegion& region, const LocatorOptions& given,
                         std::vector<TriedSettings> tried);

/// Whether two settings describe the same kind of discs: the same polarity and model, and diameters that
/// agree to a tenth. With a profile it suffices that the radii of the rims agree to a tenth.
bool same_discs(const TriedSettings& a, const TriedSettings& b);

/// Whether the choice is narrow: the runner-up has at least 0.9 of the evidence of the chosen settings. The
/// runner-up is the best setting with round discs that differ from the chosen ones in
///
/// - the diameters, by more than a tenth, or their number, unless only the runner-up has a common profile;
/// - or the number of discs, by more than a twentieth.
///
/// Part of the chosen discs does not count as different: fewer discs of the same sizes and polarity with less
/// evidence, or the discs without the size of a few (2 %).
///
/// \returns the index of the runner-up in `tried`; 0: the choice is clear, or there is no runner-up
std::size_t narrow_runner_up(const SettingsChoice& choice);

/// The index of the runner-up with any evidence; 0: there is none.
std::size_t runner_up(const SettingsChoice& choice);

}  // namespace twincell::imaging
