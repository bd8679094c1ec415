#include "imaging/settings/auto_configuration.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "core/in_parallel.hpp"
#include "core/median.hpp"
#include "imaging/find/lattice_constant.hpp"
#include "imaging/locate/picture_orientation.hpp"
#include "imaging/refine/edge_fit.hpp"
#include "imaging/refine/overlapping_fit.hpp"
#include "imaging/refine/picture_evidence.hpp"
#include "imaging/refine/picture_fit.hpp"
#include "imaging/refine/profile_fit.hpp"
#include "imaging/settings/grey_discs.hpp"
#include "imaging/settings/hypothesis_test.hpp"
#include "imaging/settings/larger_discs.hpp"
#include "imaging/settings/nearest_distances.hpp"
#include "imaging/settings/paired_spots.hpp"
#include "imaging/settings/patterned_discs.hpp"
#include "imaging/settings/polydisperse_settings.hpp"
#include "imaging/settings/profile_model_selection.hpp"
#include "imaging/settings/settings_choice.hpp"
#include "imaging/settings/size_hypotheses.hpp"

namespace twincell::imaging {

namespace {

/// The best profiles that were tried, without those of about the same size as a better one.
std::vector<FoundSettings> best_profiles(std::vector<FoundSettings> tried) {
  constexpr std::size_t kMaxProfiles = 3;
  constexpr double kSame = 0.04;
  std::stable_sort(tried.begin(), tried.end(),
                   [](const auto& a, const auto& b) { return a.explained > b.explained; });
  std::vector<FoundSettings> best;
  for (const FoundSettings& t : tried)
    if (best.size() < kMaxProfiles && std::none_of(best.begin(), best.end(), [&](const FoundSettings& b) {
          return b.bright == t.bright && std::abs(b.diameter_px / t.diameter_px - 1) < kSame;
        }))
      best.push_back(t);
  return best;
}

/// Common profiles of small discs of either polarity, for which there are hardly any votes.
std::vector<FoundSettings> small_profiles(const cv::Mat& grey, const LocatorOptions& given) {
  constexpr double kMaxDiameter_px = 12, kRatio = 1.12;
  constexpr int kExamined_px = 300;
  const cv::Mat region = busiest(grey, kExamined_px);
  std::vector<FoundSettings> tried;
  for (const bool bright : {false, true})
    for (double d = 2 * kSmallestRadius; d <= kMaxDiameter_px; d *= kRatio) {
      if (given.polarity_known && bright != given.preprocess.bright) continue;
      const ProfileTrial trial = try_profile(region, given, {bright, d});
      if (trial.explained > 0)
        tried.push_back({d, bright, trial.explained, {}, std::string(kProfileRefiner.word)});
    }
  return best_profiles(std::move(tried));
}

/// Whether discs of one layer leave some out that may be discs of another layer: those that overlap, and
/// those that were fitted to two.
bool may_overlap(const cv::Mat& grey, const LocatorOptions& given, const FoundSettings& settings) {
  constexpr double kMinShare = 0.02;  // of the beads
  constexpr std::size_t kMinDiscs = 3;
  const Located located = locate(grey, completed(settings, given));
  const auto out = static_cast<std::size_t>(
      std::count_if(located.dropped.begin(), located.dropped.end(), [](const Detection& d) {
        return d.verdict == Verdict::overlaps || d.verdict == Verdict::wrong_radius ||
               d.verdict == Verdict::unexplained;
      }));
  return out >= kMinDiscs &&
         static_cast<double>(out) >= kMinShare * static_cast<double>(located.beads.size());
}

/// What explains more than the chosen settings but is not round, if anything and of one size.
std::optional<FoundSettings> best_not_round(const SettingsChoice& choice) {
  const TriedSettings* best = not_round(choice);
  double to_beat = choice.tried.empty() ? 0 : choice.tried.front().evidence;
  for (const TriedSettings& t : choice.tried)
    if (!is_round(t) && t.evidence > to_beat) best = &t, to_beat = t.evidence;
  if (best == nullptr || !best->settings.other_diameters_px.empty()) return std::nullopt;
  return best->settings;
}

/// The plain discs of one size that were tried, those with the most evidence first, if the chosen discs have
/// a common profile and another size. Shaded spheres of two sizes look so: the profile describes one size and
/// part of the other, with a diameter between them from which neither is found.
std::vector<FoundSettings> plain_beside(const SettingsChoice& choice) {
  constexpr double kOtherSize = 0.1;
  const FoundSettings& chosen = choice.tried.front().settings;
  std::vector<FoundSettings> plain;
  if (chosen.method != kProfileRefiner.word) return plain;
  for (const TriedSettings& t : choice.tried)
    if (t.settings.method.empty() && t.settings.other_diameters_px.empty() && t.evidence > 0 &&
        t.settings.bright == chosen.bright)
      plain.push_back(t.settings);
  if (!plain.empty() && std::abs(plain.front().diameter_px / chosen.diameter_px - 1) < kOtherSize)
    plain.clear();
  return plain;
}

/// The part of a frame around a disc, in which there are other discs too.
cv::Mat region_around(const cv::Mat& frame, const LargerDisc& disc) {
  constexpr double kWider = 2;  // than the disc
  const int side = std::max(kExaminedSide, static_cast<int>(kWider * disc.diameter_px));
  const cv::Rect around(cvRound(disc.x) - side / 2, cvRound(disc.y) - side / 2, side, side);
  return frame(around & cv::Rect({}, frame.size()));
}

double largest_diameter(const FoundSettings& settings) {
  double largest = settings.diameter_px;
  for (const double other : settings.other_diameters_px) largest = std::max(largest, other);
  return largest;
}

/// The part of a frame with most structure, some discs wide even if these are large.
cv::Mat region_for_large(const cv::Mat& frame, double diameter_px) {
  constexpr double kDiscsAcross = 6;
  return busiest(frame, std::max(kExaminedSide, static_cast<int>(kDiscsAcross * diameter_px)));
}

/// The search for settings in one frame.
class SettingsSearch {
 public:
  /// \param frame in its canonical orientation
  SettingsSearch(const cv::Mat& frame, const LocatorOptions& given, int threads)
      : frame_(frame),
        given_(given),
        threads_(threads),
        grey_(busiest(frame, kExaminedSide)),
        lattice_(lattice_constant(grey_)),
        hypotheses_(size_hypotheses(grey_, given, lattice_)) {}

  /// The choice of plain discs that explain nearly all of the picture, so that the other models, which take
  /// most of the time, cannot explain clearly more. Of each polarity, the size with the sharpest votes is
  /// tried: first on a part of the picture, because in most pictures a part shows that it does not suffice.
  std::optional<SettingsChoice> plain_discs_that_suffice() {
    constexpr double kDiscsAcross = 14;
    constexpr int kMinPart = 160;
    // Shares of the possible evidence. Discs cut by the sides of a part have less of it. Beyond the share of
    // the whole, no settings with 1.05 times as many discs of the same size exist, see choose().
    constexpr double kOfPart = 0.85, kOfWhole = 1 / 1.05;
    constexpr double kOfLattice = 0.9;  // beads that do not touch, and blurred rims
    if (!is_open()) return std::nullopt;
    for (const bool bright : {false, true}) {
      const auto sharpest = std::find_if(hypotheses_.begin(), hypotheses_.end(),
                                         [&](const Hypothesis& h) { return h.bright == bright; });
      if (sharpest != hypotheses_.end()) try_all({sharpest, sharpest + 1});
    }
    if (!best_ || best_->explained <= 0) return std::nullopt;
    // The gaps of a crystal, and the middles of its beads, resemble each other as the beads do: see judge().
    if (best_->diameter_px < kOfLattice * lattice_) return std::nullopt;
    const int side = std::max(kMinPart, static_cast<int>(kDiscsAcross * best_->diameter_px));
    const cv::Mat part = busiest(grey_, side);
    if (!most_of_possible({part, 0.5 * best_->diameter_px}, kOfPart)) return std::nullopt;
    // Rings cost little evidence, but their fit is more accurate.
    if (!try_profile(part, given_, {best_->bright, best_->diameter_px}).looks_plain()) return std::nullopt;
    region_ = {grey_, 0.5 * best_->diameter_px};
    const std::optional<TriedSettings> tried = most_of_possible(region_, kOfWhole);
    if (!tried) return std::nullopt;
    others_excluded_ = true;
    return SettingsChoice{{*tried}, {}};
  }

  /// Adds plain discs of all hypotheses to the candidates; if there are none, also a few large discs.
  void propose_plain_discs() {
    constexpr double kShrink = 4;
    candidates_.clear();
    best_.reset();
    try_all(hypotheses_);
    // The size of small discs that touch does not converge in a few sweeps: blur and radius look alike.
    for (const Hypothesis& h : hypotheses_)
      if (h.diameter_px == lattice_) candidates_.push_back({lattice_, h.bright, 0, {}, {}});
    if (given_.diameter_px > 0 || (best_ && best_->explained > 0)) return;
    cv::Mat small;  // in which discs of up to 320 px are found
    cv::resize(grey_, small, {}, 1 / kShrink, 1 / kShrink, cv::INTER_AREA);
    std::vector<Hypothesis> larger = size_hypotheses(small, given_, 0);
    for (Hypothesis& h : larger) h.diameter_px *= kShrink;
    try_all(larger);
  }

  /// Adds the other models to the candidates: common profiles, pale and patterned discs.
  void propose_other_models() {
    std::vector<FoundSettings> profiles;
    if (best_ && is_open())
      if (auto found =
              select_profile_model(frame_, given_, hypotheses_, *best_, lattice_, threads_, profiles))
        best_ = found;
    const PaleDiscs pale = find_pale(grey_, given_, lattice_, hypotheses_, best_);
    if (pale.preferred) best_ = pale.best;
    if (best_) candidates_.insert(candidates_.begin(), *best_);
    for (const FoundSettings& p : best_profiles(profiles)) candidates_.push_back(p);
    if (pale.best && !pale.preferred) candidates_.push_back(*pale.best);
    if (given_.diameter_px <= 0) patterned_ = find_patterned(frame_, given_);
    if (patterned_) candidates_.push_back(*patterned_);
  }

  /// Judges the candidates by their evidence.
  SettingsChoice judge() {
    region_ = {grey_, candidates_.empty() ? 0 : 0.5 * candidates_.front().diameter_px};
    // In a crystal that fills the frame the gaps are as similar as the discs, and described as well.
    if (lattice_ > 0) region_.min_advantage = kMinAdvantageInCrystal;
    if (patterned_) region_.picture = region_for_large(frame_, patterned_->diameter_px);
    return confirmed(region_, given_, try_settings(region_, given_, candidates_, threads_));
  }

  /// The choice with further sizes, if something that is not round explains more: discs of sizes that are not
  /// searched for hide rims of the others, which then do not seem round.
  [[nodiscard]] SettingsChoice with_further_sizes(SettingsChoice choice) const {
    const auto not_round = best_not_round(choice);
    if (!not_round) return choice;
    const auto mixed = find_polydisperse(grey_, given_, hypotheses_, *not_round);
    return mixed ? with(choice, {*mixed}) : choice;
  }

  /// The choice, or that of discs that overlap in projection if it is empty: if discs of one layer are fitted
  /// to two, they explain most but do not seem round, and are up to a tenth too large. Only dark ones, for
  /// those in front block the light of those behind. The fit takes long, so that one size is tried.
  [[nodiscard]] SettingsChoice or_overlapping_discs(SettingsChoice choice) const {
    const TriedSettings* one_layer = not_round(choice);
    if (one_layer == nullptr || !is_open() || one_layer->settings.bright ||
        !one_layer->settings.method.empty() || one_layer->settings.contrast != 1)
      return choice;
    FoundSettings layers{
        largest_diameter(one_layer->settings), false, 0, {}, std::string(kOverlappingRefiner.word)};
    std::vector<double> diameters;
    for (const Detection& b : locate(grey_, completed(layers, given_)).beads)
      diameters.push_back(2 * b.radius);
    if (diameters.empty()) return choice;
    layers.diameter_px = upper_median(std::move(diameters));
    SettingsChoice found = with(choice, {layers});
    return found.tried.empty() || found.tried.front().evidence < one_layer->evidence ? choice : found;
  }

  /// The choice, or that of common profiles of small discs if it is empty.
  SettingsChoice or_small_discs(SettingsChoice choice) {
    if (!choice.tried.empty() || !is_open()) return choice;
    region_.neighbour_radius_px = kSmallestRadius;
    SettingsChoice small =
        confirmed(region_, given_, try_settings(region_, given_, small_profiles(grey_, given_), threads_));
    if (!small.tried.empty()) return explains_more(choice.refused, small.tried.front()) ? choice : small;
    return not_round(small) != nullptr || choice.refused.empty() ? small : choice;
  }

  /// The choice with grey plain discs. They are tried after small discs with a common profile, for a few of
  /// them may be found among these.
  [[nodiscard]] SettingsChoice with_grey_discs(const SettingsChoice& choice) const {
    if (!is_open() || others_excluded_) return choice;
    const std::vector<FoundSettings> grey = find_grey(grey_, given_, lattice_, threads_);
    return grey.empty() ? choice : with(choice, grey);
  }

  /// The choice with variants of its winner: its rims alone, two layers, further sizes.
  [[nodiscard]] SettingsChoice with_variants_of_winner(const SettingsChoice& choice) const {
    FoundSettings winner = choice.tried.front().settings;
    std::vector<FoundSettings> more;
    if (winner.method != kEdgeRefiner.word && winner.other_diameters_px.empty()) {
      if (auto mixed = find_polydisperse(grey_, given_, hypotheses_, winner)) more.push_back(*mixed);
      if (const std::vector<FoundSettings> plain = plain_beside(choice); !plain.empty()) {
        if (auto mixed = find_polydisperse(grey_, given_, hypotheses_, plain.front())) more.push_back(*mixed);
        for (const FoundSettings& other : plain)
          if (sizes_apart({plain.front().diameter_px}, other.diameter_px)) {
            more.push_back(plain.front());
            more.back().other_diameters_px = {other.diameter_px};
            break;
          }
      }
      if (given_.refine.method == kExactRefiner.word) {
        const bool plain = completed(winner, given_).refine.method == kExactRefiner.word;
        winner.method = kEdgeRefiner.word;
        if (!others_excluded_) more.push_back(winner);
        winner.method = kOverlappingRefiner.word;
        if (plain && may_overlap(grey_, given_, choice.tried.front().settings)) more.push_back(winner);
      }
    }
    return more.empty() ? choice : with(choice, more);
  }

  /// The choice with wider discs with a common profile, up to the usual distance of neighbours, if the chosen
  /// ones may be the highlights of larger beads: they are bright, and apart from each other or small. Next to
  /// small ones, spots between the beads may have been found too, which are nearer.
  [[nodiscard]] SettingsChoice with_wider_profiles(const SettingsChoice& choice) const {
    constexpr double kRatio = 1.25, kSmall_px = 6, kOfSmall_px = 12, kTouching = 1.1;
    constexpr std::size_t kMost = 5, kNeighbours = 500;  // profiles; discs whose neighbours are searched
    if (choice.tried.empty() || others_excluded_) return choice;
    const TriedSettings& chosen = choice.tried.front();
    const FoundSettings& of = chosen.settings;
    if (!of.bright || !of.other_diameters_px.empty() || of.method == kEdgeRefiner.word ||
        of.method == kOverlappingRefiner.word)
      return choice;
    const std::vector<double> nearest =
        nearest_distances(locate(grey_, completed(of, given_)).beads, kNeighbours);
    if (nearest.empty()) return choice;
    const double widest =
        std::max(kTouching * nearest[nearest.size() / 2], chosen.rim_px < kSmall_px ? kOfSmall_px : 0);
    std::vector<FoundSettings> wider;
    for (double d = kRatio * of.diameter_px; d <= widest && wider.size() < kMost; d *= kRatio)
      wider.push_back({d, true, 0, {}, std::string(kProfileRefiner.word)});
    return wider.empty() ? choice : with(choice, wider);
  }

  /// The choice, or that of the beads if the chosen discs are two highlights on each of them. Nothing else
  /// shows pairs in one direction, so the beads need no more evidence than their highlights have; the two
  /// spots are also why their rims may not seem round.
  [[nodiscard]] SettingsChoice with_beads_of_pairs(SettingsChoice choice) const {
    if (choice.tried.empty() || !choice.tried.front().settings.other_diameters_px.empty()) return choice;
    const FoundSettings spots = choice.tried.front().settings;
    choice.pairs = spot_pairs(locate(grey_, completed(spots, given_)).beads);
    if (!choice.pairs) return choice;
    if (auto beads = beads_of(*choice.pairs, spots)) {
      choice.tried.front().not_chosen = "its discs are in pairs, as two highlights of each bead";
      choice.tried.insert(choice.tried.begin(), std::move(*beads));
      choice.beads_of_pairs = true;
    }
    return choice;
  }

  /// The choice with the sizes of large discs that are too few for the search, such as a single intruder, if
  /// the picture around them confirms them. Those that it does not confirm are noted.
  [[nodiscard]] SettingsChoice with_larger_discs(SettingsChoice choice) const {
    constexpr std::size_t kMaxSizes = 3;
    if (choice.tried.empty()) return choice;
    std::vector<Detection> beads = locate(frame_, completed(choice.tried.front().settings, given_)).beads;
    for (;;) {
      const TriedSettings& chosen = choice.tried.front();
      choice.larger = larger_discs(frame_, beads, largest_diameter(chosen.settings));
      if (choice.larger.empty() || chosen.settings.other_diameters_px.size() + 1 >= kMaxSizes) return choice;
      std::optional<TriedSettings> more = with_size_of(choice.larger.front(), chosen);
      if (!more) return choice;
      std::vector<Detection> with = locate(frame_, completed(more->settings, given_)).beads;
      if (with.size() <= beads.size()) return choice;
      beads = std::move(with);
      choice.tried.insert(choice.tried.begin(), std::move(*more));
    }
  }

  /// The lattice constant of a crystal that fills the frame, if the chosen discs cover less than 0.3 of it.
  [[nodiscard]] double uncovered_lattice_px(const SettingsChoice& choice) const {
    constexpr double kCovered = 0.3;
    if (choice.tried.empty()) return 0;
    const TriedSettings& chosen = choice.tried.front();
    const double radius = 0.5 * chosen.settings.diameter_px,
                 area = std::numbers::pi * radius * radius * static_cast<double>(chosen.beads);
    return area < kCovered * static_cast<double>(grey_.total()) ? lattice_ : 0;
  }

 private:
  /// Settings whose discs, wider than the spots, are between the two of a pair each, with the largest
  /// evidence; nothing if there are none.
  [[nodiscard]] std::optional<TriedSettings> beads_of(const SpotPairs& pairs,
                                                      const FoundSettings& spots) const {
    constexpr double kRatio = 1.12, kOther = 0.1;
    std::vector<FoundSettings> wider;
    const double apart = std::hypot(pairs.dx_px, pairs.dy_px);
    const double narrowest = std::max(apart, spots.diameter_px);
    const SpotPairs in_frame = spot_pairs(locate(frame_, completed(spots, given_)).beads).value_or(pairs);
    for (double d = pairs.touching_px; d > narrowest; d /= kRatio)
      wider.push_back({d, spots.bright, 0, {}, std::string(kProfileRefiner.word)});
    const auto has_one_each = [&](const TriedSettings& t) {
      return t.evidence > 0 &&
             std::abs(static_cast<double>(t.beads) / static_cast<double>(pairs.middles.size()) - 1) < kOther;
    };
    std::vector<TriedSettings> tried = try_settings(region_, given_, wider, threads_);
    std::stable_sort(tried.begin(), tried.end(),
                     [](const auto& a, const auto& b) { return a.evidence > b.evidence; });
    for (const TriedSettings& t : tried) {
      if (!has_one_each(t)) continue;
      TriedSettings beads = tried_in_full(region_, given_, t.settings);
      if (has_one_each(beads) && are_between(locate(frame_, completed(t.settings, given_)).beads, in_frame))
        return beads;
    }
    return std::nullopt;
  }

  /// Settings with the size of a larger disc in addition; nothing if the picture around it does not gain what
  /// a bead does, or if discs of one size alone can be fitted.
  [[nodiscard]] std::optional<TriedSettings> with_size_of(const LargerDisc& disc,
                                                          const TriedSettings& chosen) const {
    FoundSettings more = chosen.settings;
    if (model_of(completed(more, given_).refine) == DiscModel::shared_profile || disc.bright != more.bright)
      return std::nullopt;
    more.other_diameters_px.push_back(disc.diameter_px);
    const ExaminedRegion region{region_around(frame_, disc), region_.neighbour_radius_px};
    const std::vector<TriedSettings> tried = try_settings(region, given_, {chosen.settings, more}, threads_);
    const double gain = tried[1].evidence - tried[0].evidence,
                 share = tried[0].evidence / static_cast<double>(std::max<std::size_t>(1, tried[0].beads));
    if (gain < share || !is_round(tried[1])) return std::nullopt;
    TriedSettings with = tried[1];
    with.evidence = chosen.evidence + gain;
    with.beads = chosen.beads + tried[1].beads - std::min(tried[0].beads, tried[1].beads);
    return with;
  }

  /// Whether round discs that were refused for their little evidence a disc have more of it in all: a few
  /// gaps of a crystal are not the beads.
  [[nodiscard]] static bool explains_more(const std::vector<TriedSettings>& refused,
                                          const TriedSettings& than) {
    return std::any_of(refused.begin(), refused.end(),
                       [&](const TriedSettings& t) { return is_round(t) && t.evidence > than.evidence; });
  }

  /// Whether the options leave the model of the discs open.
  [[nodiscard]] bool is_open() const {
    return given_.other_diameters_px.empty() && given_.refine.method == kExactRefiner.word;
  }

  /// The best plain discs as tried in a region, if they are round and have a share of its possible evidence.
  [[nodiscard]] std::optional<TriedSettings> most_of_possible(const ExaminedRegion& region,
                                                              double share) const {
    const TriedSettings tried = tried_in_full(region, given_, *best_);
    // At the distances of small discs, the rims of large ones seem straight. At large distances, smooth light
    // and the outline of a packing count too.
    constexpr double kOfWide = 0.75;
    const double possible = std::max(possible_evidence(region.picture, region.neighbour_radius_px),
                                     kOfWide * possible_evidence(region.picture, kLargestRadius));
    if (!is_round(tried) || tried.beads == 0 || tried.evidence < share * possible) return std::nullopt;
    return tried;
  }

  void try_all(const std::vector<Hypothesis>& some) {
    std::vector<FoundSettings> settled(some.size());
    in_parallel(some.size(), threads_, [&](std::size_t k) {
      const Trial trial = settle_plain(grey_, given_, some[k]);
      settled[k] = {trial.diameter_px, some[k].bright, trial.explained, {}, {}};
    });
    for (const FoundSettings& found : settled) {
      if (found.explained > 0 || given_.diameter_px > 0) candidates_.push_back(found);
      if (!best_ || found.explained > best_->explained) best_ = found;
    }
  }

  /// The choice among what was tried before and more.
  [[nodiscard]] SettingsChoice with(const SettingsChoice& choice,
                                    const std::vector<FoundSettings>& more) const {
    std::vector<TriedSettings> every = choice.tried;
    for (const TriedSettings& t : choice.refused)
      if (!is_round(t)) every.push_back(t);
    for (const TriedSettings& t : try_settings(region_, given_, more, threads_)) every.push_back(t);
    return confirmed(region_, given_, std::move(every));
  }

  const cv::Mat& frame_;
  const LocatorOptions& given_;
  int threads_;
  cv::Mat grey_;    ///< the part of the frame with most structure
  double lattice_;  ///< lattice constant, px; 0: no crystal
  std::vector<Hypothesis> hypotheses_;
  std::vector<FoundSettings> candidates_;
  bool others_excluded_ = false;  ///< by plain_discs_that_suffice()
  std::optional<FoundSettings> best_, patterned_;
  ExaminedRegion region_;
};

}  // namespace

namespace {

/// Share of the pixels that have the brightest grey level of a picture.
double brightest_share(const cv::Mat& picture) {
  double least = 0, most = 0;
  cv::minMaxLoc(picture, &least, &most);
  return least < most
             ? static_cast<double>(cv::countNonZero(picture == most)) / static_cast<double>(picture.total())
             : 0;
}

}  // namespace

SettingsChoice choose_settings(const cv::Mat& picture, const LocatorOptions& given, int threads) {
  // A frame too small for a disc of the smallest radius contains no information on the size.
  if (given.diameter_px <= 0 && std::min(picture.cols, picture.rows) < 2 * kSmallestRadius) return {};
  // Orientation: canonical, as in `locate`, so that a rotated picture has the same settings.
  const PictureOrientation orientation = canonical_picture_orientation(picture);
  const cv::Mat frame = orientation.turned(picture);
  SettingsSearch search(frame, given, threads);
  std::optional<SettingsChoice> sufficient = search.plain_discs_that_suffice();
  SettingsChoice choice;
  if (sufficient) {
    choice = *sufficient;
  } else {
    search.propose_plain_discs();
    search.propose_other_models();
    choice = search.judge();
  }
  const auto with_saturation = [&](SettingsChoice chosen) {
    if (!chosen.tried.empty() && !chosen.tried.front().settings.bright)
      chosen.saturated = brightest_share(picture);
    return chosen;
  };
  if (given.diameter_px > 0 || model_of(given.refine) != DiscModel::plain)
    return with_saturation(std::move(choice));
  choice = search.or_overlapping_discs(search.with_further_sizes(std::move(choice)));
  choice = search.with_grey_discs(search.or_small_discs(std::move(choice)));
  if (choice.tried.empty()) return choice;
  choice = search.with_wider_profiles(search.with_variants_of_winner(choice));
  choice = search.with_larger_discs(search.with_beads_of_pairs(std::move(choice)));
  for (LargerDisc& d : choice.larger) {
    Detection place;
    place.x = d.x, place.y = d.y;
    place = orientation.back(place, picture.size());
    d.x = place.x, d.y = place.y;
  }
  choice.suffices = sufficient.has_value();
  choice.uncovered_lattice_px = search.uncovered_lattice_px(choice);
  return with_saturation(std::move(choice));
}

bool confirms(const cv::Mat& picture, const SettingsChoice& choice, const LocatorOptions& given,
              int threads) {
  constexpr std::size_t kMost = 2;
  constexpr double kPart = 0.5;  // of the evidence of the chosen ones
  const TriedSettings& chosen = choice.tried.front();
  std::vector<FoundSettings> rivals;  // in the order of choose(): the preferred ones first
  for (const TriedSettings& t : choice.tried)
    if (is_round(t) && t.evidence >= kPart * chosen.evidence && (rivals.size() < kMost || t.preferred))
      rivals.insert(t.preferred ? rivals.begin() : rivals.end(), t.settings);
  const cv::Mat frame = canonical_picture_orientation(picture).turned(picture);
  const ExaminedRegion region{region_for_large(frame, chosen.settings.diameter_px),
                              0.5 * chosen.settings.diameter_px};
  const SettingsChoice here = choose(try_settings(region, given, rivals, threads));
  return !here.tried.empty() && same_discs(here.tried.front(), chosen);
}

std::optional<FoundSettings> find_settings(const cv::Mat& picture, const LocatorOptions& given) {
  const SettingsChoice choice = choose_settings(picture, given);
  if (choice.tried.empty()) return std::nullopt;
  return choice.tried.front().settings;
}

}  // namespace twincell::imaging
