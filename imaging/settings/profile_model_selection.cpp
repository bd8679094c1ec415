#include "imaging/settings/profile_model_selection.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "core/in_parallel.hpp"
#include "imaging/refine/profile_fit.hpp"

namespace twincell::imaging {

namespace {

constexpr double kClose = 0.02, kTolerance = 0.2;  // relative differences of diameters

/// The best common profile so far, and the best plain discs proposed by profiles.
class ProfileModelSearch {
 public:
  ProfileModelSearch(const cv::Mat& grey, const LocatorOptions& given, const FoundSettings& plain)
      : grey_(grey), given_(given), best_{plain.bright, plain.diameter_px} {
    best_trial_ = tried(best_, tried_);
  }

  /// Every size and polarity whose common profile explains something.
  [[nodiscard]] const std::vector<FoundSettings>& tried() const { return tried_; }

  /// Tries each hypothesis, extended to its rim. A profile has more freedom than a plain disc, so it must be
  /// clearly better than the profile at the size of the plain discs.
  void try_all(const std::vector<Hypothesis>& all, double lattice, int threads) {
    constexpr double kMinAdvantage = 1.25, kLatticeShare = 0.15;
    if (best_trial_.overlaps || std::abs(best_.diameter_px - lattice) < kLatticeShare * lattice)
      try_as_plain(best_);
    double to_beat = kMinAdvantage * best_trial_.explained;
    std::vector<Extended> extended(all.size());
    in_parallel(all.size(), threads, [&](std::size_t k) { extended[k] = extended_to_rim(all[k]); });
    for (auto& [h, trial, steps] : extended) {
      keep(steps);
      if (lattice > 0 && trial.looks_plain()) try_as_plain({h.bright, 2 * trial.profile.rim()});
      if (trial.explained <= to_beat) continue;
      to_beat = trial.explained;
      accept(h, std::move(trial));
    }
  }

  /// Tries wider discs: a ring may hide another ring outside it, for which there are no votes.
  void try_wider() {
    constexpr double kWider = 1.12, kWiderRim = 1.05;
    for (const double ratio : {kWider, kWider * kWider}) {
      Hypothesis wider{best_.bright, ratio * best_.diameter_px};
      if (!allowed(wider)) return;
      auto [rim, trial, steps] = extended_to_rim(wider);
      keep(steps);
      if (trial.explained <= best_trial_.explained ||
          trial.profile.rim() <= kWiderRim * best_trial_.profile.rim())
        continue;
      accept(rim, std::move(trial));
      return;
    }
  }

  /// Tries the other polarity: for discs with dark and bright rings, the background is more uniform in one of
  /// them.
  void try_inverted() {
    constexpr double kBetter = 1.1;
    const Hypothesis other{!best_.bright, best_.diameter_px};
    if (!allowed(other)) return;
    ProfileTrial trial = tried(other, tried_);
    if (trial.explained > kBetter * best_trial_.explained &&
        std::abs(trial.profile.rim() / best_trial_.profile.rim() - 1) < kClose)
      accept(other, std::move(trial));
  }

  /// Tries plain discs of the size of the best profile, and of the size of its rim.
  void try_best_as_plain() {
    for (const double d : {best_.diameter_px, 2 * best_trial_.profile.rim()}) try_as_plain({best_.bright, d});
  }

  [[nodiscard]] bool found_nothing() const {
    return best_trial_.explained <= 0 && best_plain_.explained <= 0;
  }
  [[nodiscard]] bool plain_suffices() const {
    constexpr double kAsGood = 0.6;  // a profile has more freedom, and rejects false discs less reliably
    return best_plain_.explained > (best_trial_.looks_plain() ? kAsGood : 1) * best_trial_.explained;
  }

  /// The settings found; empty if they agree with `plain`.
  [[nodiscard]] std::optional<FoundSettings> result(const FoundSettings& plain) const {
    FoundSettings found{best_.diameter_px, best_.bright, best_trial_.explained, {}, {}};
    if (plain_suffices())
      found = best_plain_;
    else if (!best_trial_.looks_plain())
      found.method = kProfileRefiner.word;
    if (found.method.empty() && found.bright == plain.bright &&
        std::abs(found.diameter_px / plain.diameter_px - 1) < kTolerance)
      return std::nullopt;
    const Hypothesis rim{best_.bright, 2 * best_trial_.profile.rim()};
    if (!plain_suffices() && allowed(rim) && given_.diameter_px <= 0) found.diameter_px = rim.diameter_px;
    return found;
  }

 private:
  /// A hypothesis extended to its rim, and what was tried on the way.
  struct Extended {
    Hypothesis h;
    ProfileTrial trial;
    std::vector<FoundSettings> steps;
  };

  ProfileTrial tried(const Hypothesis& h, std::vector<FoundSettings>& steps) const {
    ProfileTrial trial = try_profile(grey_, given_, h);
    if (trial.explained > 0)
      steps.push_back({h.diameter_px, h.bright, trial.explained, {}, std::string(kProfileRefiner.word)});
    return trial;
  }
  void keep(const std::vector<FoundSettings>& steps) {
    tried_.insert(tried_.end(), steps.begin(), steps.end());
  }
  void accept(const Hypothesis& h, ProfileTrial trial) {
    best_ = h;
    best_trial_ = std::move(trial);
  }
  [[nodiscard]] bool allowed(const Hypothesis& h) const {
    return h.diameter_px >= 2 * kSmallestRadius &&
           (given_.diameter_px <= 0 || std::abs(h.diameter_px / given_.diameter_px - 1) <= kTolerance) &&
           (!given_.polarity_known || h.bright == given_.preprocess.bright);
  }
  /// Tries a hypothesis and extends its size to the rim that its profile shows, as long as this explains
  /// more.
  [[nodiscard]] Extended extended_to_rim(const Hypothesis& first) const {
    constexpr int kRounds = 2;
    Extended all{.h = first, .trial = {}, .steps = {}};
    auto& [h, trial, steps] = all;
    trial = tried(h, steps);
    for (int round = 0; round < kRounds && trial.explained > 0; ++round) {
      const double rim = trial.profile.rim();
      const bool inverted = trial.profile.at(0.95 * rim) < 0;
      const Hypothesis next{h.bright != inverted, 2 * rim};
      if (!allowed(next) || (!inverted && std::abs(next.diameter_px / h.diameter_px - 1) < kClose)) break;
      ProfileTrial out = tried(next, steps);
      if (out.explained <= trial.explained) break;
      h = next;
      trial = std::move(out);
    }
    return all;
  }
  /// Tries plain discs of the size that the profiles show, or as wide as the lattice constant. Where discs
  /// fill the frame as a crystal, a profile cannot distinguish disc from ground: it may fail at the discs and
  /// succeed at the gaps.
  void try_as_plain(const Hypothesis& h) {
    const Trial trial = settle_plain(grey_, given_, {h.bright, std::max(h.diameter_px, 2 * kSmallestRadius)});
    if (trial.explained > best_plain_.explained)
      best_plain_ = {trial.diameter_px, h.bright, trial.explained, {}, {}};
  }

  const cv::Mat& grey_;
  const LocatorOptions& given_;
  Hypothesis best_;
  ProfileTrial best_trial_;
  FoundSettings best_plain_;
  std::vector<FoundSettings> tried_;
};

}  // namespace

std::optional<FoundSettings> select_profile_model(const cv::Mat& frame, const LocatorOptions& given,
                                                  const std::vector<Hypothesis>& all,
                                                  const FoundSettings& plain, double lattice, int threads,
                                                  std::vector<FoundSettings>& tried) {
  constexpr int kDiscs = 14;  // discs across the region that is examined
  double largest = plain.diameter_px;
  for (const Hypothesis& h : all) largest = std::max(largest, h.diameter_px);
  const cv::Mat grey = busiest(frame, std::clamp(static_cast<int>(kDiscs * largest), 160, 360));
  ProfileModelSearch search(grey, given, plain);
  search.try_all(all, lattice, threads);
  std::optional<FoundSettings> found;
  if (!search.found_nothing()) {
    if (!search.plain_suffices()) {
      search.try_wider();
      search.try_inverted();
      search.try_best_as_plain();
    }
    found = search.result(plain);
  }
  tried.insert(tried.end(), search.tried().begin(), search.tried().end());
  return found;
}

}  // namespace twincell::imaging
