#include "imaging/settings/profile_model_selection.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace twincell {

namespace {

constexpr double kClose = 0.02, kTolerance = 0.2;  // of the diameter

/// The best common profile so far, and the best plain discs that profiles led to.
class AlikeSearch {
 public:
  AlikeSearch(const cv::Mat& grey, const LocatorOptions& given, const FoundSettings& plain)
      : grey_(grey), given_(given), best_{plain.bright, plain.diameter_px} {
    of_best_ = try_profile(grey_, given_, best_);
  }

  /// Each of the hypotheses, led out to its rim: a profile is freer than a plain disc, so it has to be
  /// clearly better than the one at the size of the plain ones.
  void try_all(const std::vector<Hypothesis>& all, double lattice) {
    constexpr double kClearly = 1.25, kNear = 0.15;
    if (of_best_.overlaps || std::abs(best_.diameter_px - lattice) < kNear * lattice) try_as_plain(best_);
    double to_beat = kClearly * of_best_.explained;
    for (Hypothesis h : all) {
      ProfileTrial trial = led_out(h);
      if (lattice > 0 && trial.looks_plain()) try_as_plain({h.bright, 2 * trial.profile.rim()});
      if (trial.explained <= to_beat) continue;
      to_beat = trial.explained;
      take(h, std::move(trial));
    }
  }

  /// A ring may hide the one that is outside it, of which votes say nothing.
  void look_wider() {
    constexpr double kWider = 1.12, kWiderRim = 1.05;
    for (const double ratio : {kWider, kWider * kWider}) {
      Hypothesis wider{best_.bright, ratio * best_.diameter_px};
      if (!allowed(wider)) return;
      ProfileTrial trial = led_out(wider);
      if (trial.explained <= of_best_.explained || trial.profile.rim() <= kWiderRim * of_best_.profile.rim())
        continue;
      take(wider, std::move(trial));
      return;
    }
  }

  /// Of discs with both dark and bright rings, what lies behind is seen more evenly by one of the polarities.
  void look_inverted() {
    constexpr double kBetter = 1.1;
    const Hypothesis other{!best_.bright, best_.diameter_px};
    if (!allowed(other)) return;
    ProfileTrial trial = try_profile(grey_, given_, other);
    if (trial.explained > kBetter * of_best_.explained &&
        std::abs(trial.profile.rim() / of_best_.profile.rim() - 1) < kClose)
      take(other, std::move(trial));
  }

  /// Plain discs of the size of the best profile, and of its rim.
  void try_best_as_plain() {
    for (const double d : {best_.diameter_px, 2 * of_best_.profile.rim()}) try_as_plain({best_.bright, d});
  }

  [[nodiscard]] bool found_nothing() const { return of_best_.explained <= 0 && as_plain_.explained <= 0; }
  [[nodiscard]] bool plain_does() const {
    constexpr double kAsGood = 0.6;  // a profile is freer, and what is no disc easier to miss
    return as_plain_.explained > (of_best_.looks_plain() ? kAsGood : 1) * of_best_.explained;
  }

  /// None if that is `plain`.
  [[nodiscard]] std::optional<FoundSettings> result(const FoundSettings& plain) const {
    FoundSettings found{best_.diameter_px, best_.bright, of_best_.explained, {}, {}};
    if (plain_does())
      found = as_plain_;
    else if (!of_best_.looks_plain())
      found.method = kProfileRefiner.word;
    if (found.method.empty() && found.bright == plain.bright &&
        std::abs(found.diameter_px / plain.diameter_px - 1) < kTolerance)
      return std::nullopt;
    const Hypothesis rim{best_.bright, 2 * of_best_.profile.rim()};
    if (!plain_does() && allowed(rim) && given_.diameter_px <= 0) found.diameter_px = rim.diameter_px;
    return found;
  }

 private:
  void take(const Hypothesis& h, ProfileTrial trial) {
    best_ = h;
    of_best_ = std::move(trial);
  }
  [[nodiscard]] bool allowed(const Hypothesis& h) const {
    return h.diameter_px >= 2 * kSmallestRadius &&
           (given_.diameter_px <= 0 || std::abs(h.diameter_px / given_.diameter_px - 1) <= kTolerance) &&
           (!given_.polarity_known || h.bright == given_.preprocess.bright);
  }
  ProfileTrial led_out(Hypothesis& h) const {
    constexpr int kRounds = 2;
    ProfileTrial trial = try_profile(grey_, given_, h);
    for (int round = 0; round < kRounds && trial.explained > 0; ++round) {
      const double rim = trial.profile.rim();
      const bool inverted = trial.profile.at(0.95 * rim) < 0;
      const Hypothesis next{h.bright != inverted, 2 * rim};
      if (!allowed(next) || (!inverted && std::abs(next.diameter_px / h.diameter_px - 1) < kClose)) break;
      ProfileTrial out = try_profile(grey_, given_, next);
      if (out.explained <= trial.explained) break;
      h = next;
      trial = std::move(out);
    }
    return trial;
  }
  /// Plain discs as the profiles show them, or as wide as they lie apart. Where discs fill the frame as a
  /// crystal nothing tells a profile what is disc and what is ground: it may fail at the discs, and not at
  /// the gaps.
  void try_as_plain(const Hypothesis& h) {
    const Trial trial = settle_plain(grey_, given_, {h.bright, std::max(h.diameter_px, 2 * kSmallestRadius)});
    if (trial.explained > as_plain_.explained)
      as_plain_ = {trial.diameter_px, h.bright, trial.explained, {}, {}};
  }

  const cv::Mat& grey_;
  const LocatorOptions& given_;
  Hypothesis best_;
  ProfileTrial of_best_;
  FoundSettings as_plain_;
};

}  // namespace

std::optional<FoundSettings> select_profile_model(const cv::Mat& frame, const LocatorOptions& given,
                                                  const std::vector<Hypothesis>& all,
                                                  const FoundSettings& plain, double lattice) {
  constexpr int kDiscs = 14;  // across the part that is looked at
  double largest = plain.diameter_px;
  for (const Hypothesis& h : all) largest = std::max(largest, h.diameter_px);
  const cv::Mat grey = busiest(frame, std::clamp(static_cast<int>(kDiscs * largest), 160, 360));
  AlikeSearch search(grey, given, plain);
  search.try_all(all, lattice);
  if (search.found_nothing()) return std::nullopt;
  if (!search.plain_does()) {
    search.look_wider();
    search.look_inverted();
    search.try_best_as_plain();
  }
  return search.result(plain);
}

}  // namespace twincell
