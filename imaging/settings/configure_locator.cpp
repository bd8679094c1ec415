#include "imaging/settings/configure_locator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <utility>
#include <vector>

#include "core/error.hpp"
#include "core/median.hpp"
#include "imaging/refine/picture_evidence.hpp"
#include "imaging/settings/auto_configuration.hpp"
#include "imaging/settings/find_contrast.hpp"
#include "imaging/settings/nearest_distances.hpp"
#include "imaging/settings/settings_choice.hpp"

namespace twincell::imaging {

namespace {

/// Whether all pixels are equal. A search for discs in such a frame, or in one of a few pixels, takes as long
/// as in any other and finds nothing.
bool is_blank(const cv::Mat& frame) {
  double low = 0, high = 0;
  cv::minMaxLoc(frame, &low, &high);
  return low == high;
}

std::vector<double> radii_of(const std::vector<Detection>& beads) {
  std::vector<double> radii;
  radii.reserve(beads.size());
  for (const Detection& b : beads) radii.push_back(b.radius);
  return radii;
}

/// The settings with a size that is known; nothing if they then locate fewer discs than `least`.
std::optional<LocatorOptions> at_known_size(const cv::Mat& frame, LocatorOptions settled, std::size_t least) {
  settled.size_known = true;
  return locate(frame, settled).beads.size() >= least ? std::optional(std::move(settled)) : std::nullopt;
}

/// The settings with the diameter of the rims, unless they then locate fewer discs. A profile describes discs
/// of another diameter as well, so that the evidence hardly determines it.
LocatorOptions at_rim(const cv::Mat& frame, LocatorOptions settled, const std::vector<Detection>& beads) {
  // The rim may be that of a highlight, far inside of discs that fade outwards.
  constexpr double kFarInside = 0.6;
  const double rim_px = 2 * upper_median(radii_of(beads));
  if (rim_px < kFarInside * settled.diameter_px)
    if (auto known = at_known_size(frame, settled, beads.size())) return *known;
  LocatorOptions rim = settled;
  rim.diameter_px = std::clamp(rim_px, 3.0, 400.0);
  return at_known_size(frame, std::move(rim), beads.size()).value_or(std::move(settled));
}

/// The settings, with pale discs if the frame shows a second population of the beads, as of pale tracers: at
/// least three discs of one darkness, some of them below that of which discs usually count. Some of tracers
/// at that darkness are found without, so that those below it may be fewer than three.
LocatorOptions with_pale_discs(const cv::Mat& frame, const LocatorOptions& settled) {
  constexpr double kUsualDarkness = 0.4, kMaxPaleDarkness = 0.46;
  constexpr double kAlike = 0.12;  // largest scatter of the darkness, relative
  constexpr std::size_t kMinPaleDiscs = 3;
  if (model_of(settled.refine) != DiscModel::plain) return settled;
  LocatorOptions options = settled;
  options.refine.pale = true;
  const std::vector<Detection> with = locate(frame, options).beads;
  std::vector<double> pale;
  std::size_t below = 0;
  for (const Detection& b : with) {
    if (b.darkness < kMaxPaleDarkness) pale.push_back(b.darkness);
    if (b.darkness < kUsualDarkness) ++below;
  }
  if (pale.size() < kMinPaleDiscs) return settled;
  const std::size_t without = locate(frame, settled).beads.size();
  if (with.size() < without + std::max<std::size_t>(below, 1)) return settled;
  const double typical = upper_median(pale);
  return robust_spread(std::move(pale), typical) < kAlike * typical ? options : settled;
}

/// The settings, with a tolerance of the radii for beads of a broad distribution of sizes: four times its
/// standard deviation about the nearest of the sizes, if this locates more.
LocatorOptions with_spread_of_sizes(const cv::Mat& frame, const LocatorOptions& settled) {
  constexpr double kDeviations = 4, kMost = 0.4;
  constexpr std::size_t kMinBeads = 20;
  if (model_of(settled.refine) != DiscModel::plain) return settled;
  const std::vector<Detection> beads = locate(frame, settled).beads;
  if (beads.size() < kMinBeads) return settled;
  const std::vector<double> sizes = settled.radii_px();
  std::vector<double> relative;
  for (const Detection& b : beads) relative.push_back(b.radius / sizes[nearest_size(b.radius, sizes)]);
  const double middle = upper_median(relative);
  LocatorOptions wide = settled;
  wide.judge.radius_tolerance = std::min(kMost, kDeviations * robust_spread(std::move(relative), middle));
  if (wide.judge.radius_tolerance <= kRadiusTolerance) return settled;
  return locate(frame, wide).beads.size() > beads.size() ? wide : settled;
}

constexpr std::size_t kNeighbours = 2000;  // discs whose neighbours are searched

/// The smallest distance of two discs, px, if they may be the highlights of larger beads: that of a tenth of
/// them is more than two diameters, and they are less than 6 px wide or most have a neighbour at that
/// distance, as beads that touch. 0: they are not.
double distance_of_parts(const std::vector<Detection>& beads, const LocatorOptions& settled) {
  constexpr std::size_t kMinDiscs = 20;
  constexpr double kFew = 0.1, kDiameters = 2, kSmall_px = 6, kTouching = 1.1;
  if (beads.size() < kMinDiscs || !settled.other_diameters_px.empty()) return 0;
  const std::vector<double> nearest = nearest_distances(beads, kNeighbours);
  const auto n = static_cast<double>(nearest.size());
  const double closest = nearest[static_cast<std::size_t>(kFew * n)], half = nearest[nearest.size() / 2];
  if (closest <= kDiameters * settled.diameter_px) return 0;
  return settled.diameter_px < kSmall_px || half < kTouching * closest ? closest : 0;
}

/// Whether discs are bright and their levels do not end at the fitted rim as those of plain discs do,
/// although the picture is hardly noisy: shaded spheres fade outwards, and their rim is found too far inside.
bool fade_outwards(const cv::Mat& frame, const std::vector<Detection>& beads, const LocatorOptions& settled) {
  constexpr double kPlain = 0.985, kMaxNoise = 0.04;  // score; in the contrast of the beads
  if (!settled.preprocess.bright) return false;
  std::vector<double> scores, contrasts;
  for (const Detection& b : beads) {
    scores.push_back(b.score);
    contrasts.push_back(std::abs(b.raw_mass) / (std::numbers::pi * b.radius * b.radius));
  }
  cv::Mat1f levels;
  frame.convertTo(levels, CV_32F);
  return upper_median(std::move(scores)) < kPlain &&
         noise_level(levels) < kMaxNoise * upper_median(std::move(contrasts));
}

/// The distance of neighbours, px, if it is the width of beads that touch and are located too small: nearly
/// all discs have a neighbour at one distance, which is larger than the width of the discs, and they fade
/// outwards. 0: it is not.
double width_by_neighbours(const cv::Mat& frame, const std::vector<Detection>& beads,
                           const LocatorOptions& settled) {
  constexpr std::size_t kMinDiscs = 30;
  constexpr double kMost = 0.8, kAlike = 0.03;  // of the discs; of their distance
  constexpr double kWider = 1.15;
  if (beads.size() < kMinDiscs || !settled.other_diameters_px.empty()) return 0;
  const std::vector<double> nearest = nearest_distances(beads, kNeighbours);
  const double typical = nearest[nearest.size() / 2];
  const auto alike = std::count_if(nearest.begin(), nearest.end(),
                                   [&](double r) { return std::abs(r - typical) < kAlike * typical; });
  if (static_cast<double>(alike) < kMost * static_cast<double>(nearest.size()) ||
      typical <= kWider * 2 * upper_median(radii_of(beads)) || !fade_outwards(frame, beads, settled))
    return 0;
  return typical;
}

/// The first harmonic of the levels just inside the rim of a disc, in its contrast.
cv::Point2d lit_side(const cv::Mat1f& levels, const Detection& bead) {
  constexpr double kFrom = 0.7, kTo = 0.95;  // of the radius: outside of most highlights
  const double contrast = std::abs(bead.raw_mass) / (std::numbers::pi * bead.radius * bead.radius);
  cv::Point2d sum;
  double mean = 0, n = 0;
  cv::Point2d directions;  // of all pixels, which are not quite evenly spread
  const int reach = static_cast<int>(std::ceil(bead.radius)), cx = cvRound(bead.x), cy = cvRound(bead.y);
  for (int y = std::max(0, cy - reach); y <= std::min(levels.rows - 1, cy + reach); ++y)
    for (int x = std::max(0, cx - reach); x <= std::min(levels.cols - 1, cx + reach); ++x) {
      const cv::Point2d from(x - bead.x, y - bead.y);
      const double r = std::hypot(from.x, from.y);
      if (r < kFrom * bead.radius || r > kTo * bead.radius) continue;
      const cv::Point2d direction = from / r;
      const auto level = static_cast<double>(levels(y, x));
      sum += level * direction, directions += direction;
      mean += level, n += 1;
    }
  if (n == 0 || contrast == 0) return {};
  return (sum - directions * (mean / n)) * (2 / (n * contrast));
}

/// How much the levels at the rims differ between the lit side of the discs and their mean, in the contrast
/// of the discs, if most are lit from the same side. The fit, whose discs are even, moves their centres
/// towards the light. 0: they are not, or too few are inside the frame.
double one_sided_shading(const cv::Mat& frame, const std::vector<Detection>& beads) {
  constexpr std::size_t kMinDiscs = 20;
  constexpr double kLeast = 0.04, kMost = 0.55;  // of the contrast; of the discs
  constexpr double kAlike = 0.6;                 // deviation from the common harmonic, in its size
  cv::Mat1f levels;
  frame.convertTo(levels, CV_32F);
  std::vector<cv::Point2d> sides;
  std::vector<double> x, y;
  for (const Detection& b : beads) {
    if (b.edge) continue;
    sides.push_back(lit_side(levels, b));
    x.push_back(sides.back().x), y.push_back(sides.back().y);
  }
  if (sides.size() < kMinDiscs) return 0;
  const cv::Point2d common(upper_median(std::move(x)), upper_median(std::move(y)));
  const double size = std::hypot(common.x, common.y);
  const auto alike = std::count_if(sides.begin(), sides.end(), [&](const cv::Point2d& s) {
    return std::hypot(s.x - common.x, s.y - common.y) < kAlike * size;
  });
  return size > kLeast && static_cast<double>(alike) > kMost * static_cast<double>(sides.size()) ? size : 0;
}

/// The median width of discs, px, if they are smaller than the beads that can be located well. 0: they are
/// not.
double width_of_spots(const std::vector<Detection>& beads, const LocatorOptions& settled) {
  constexpr double kSmallest_px = 5;
  if (beads.empty() || !settled.other_diameters_px.empty()) return 0;
  const double width = 2 * upper_median(radii_of(beads));
  return width < kSmallest_px ? width : 0;
}

/// A frame and the settings chosen on it.
struct ChoiceOnFrame {
  std::size_t number = 0;
  SettingsChoice choice;
};

/// The last two of the frames 1, 2, 4, 8 and 16 that lie behind a frame and are not blank. Frames further on
/// would have to be kept in memory.
std::vector<std::size_t> later_frames(FramesAhead& frames, std::size_t behind) {
  constexpr std::size_t kLast = 16, kWitnesses = 2;
  std::vector<std::size_t> later;
  for (std::size_t k = 1; k <= kLast; k *= 2) {
    const cv::Mat* frame = frames.look(k);
    if (frame == nullptr) break;
    if (k <= behind || is_blank(*frame)) continue;
    later.push_back(k);
    if (later.size() > kWitnesses) later.erase(later.begin());
  }
  return later;
}

/// The choice on one frame, or that on a later one if two later frames agree against it: the frame may show
/// the beads behind a hand, out of focus or in a flash. The search is repeated only if neither of the later
/// frames confirms the choice, because it takes as long as locating many frames.
ChoiceOnFrame of_most_frames(FramesAhead& frames, ChoiceOnFrame first, const LocatorOptions& given,
                             int threads) {
  const std::vector<std::size_t> later = later_frames(frames, first.number);
  if (later.size() < 2) return first;
  for (const std::size_t k : later)
    if (confirms(*frames.look(k), first.choice, given, threads)) return first;
  std::vector<SettingsChoice> choices;
  for (const std::size_t k : later) {
    choices.push_back(choose_settings(*frames.look(k), given, threads));
    const std::vector<TriedSettings>& tried = choices.back().tried;
    if (tried.empty() || same_discs(tried.front(), first.choice.tried.front())) return first;
  }
  if (!same_discs(choices[0].tried.front(), choices[1].tried.front())) return first;
  return {later[0], std::move(choices[0])};
}

/// The given options with the settings chosen on a frame.
LocatorOptions settled_on(const cv::Mat& frame, const SettingsChoice& choice, const LocatorOptions& given) {
  LocatorOptions settled = completed(choice.tried.front().settings, given);
  if (model_of(settled.refine) == DiscModel::circle)
    settled.preprocess.contrast = find_contrast(frame, settled);
  return settled;
}

/// The settings, adapted to the beads that they locate in the frame on which they were chosen.
LocatorConfiguration adapted(const cv::Mat& frame, ChoiceOnFrame chosen, const LocatorOptions& given) {
  LocatorOptions settled = settled_on(frame, chosen.choice, given);
  if (chosen.choice.beads_of_pairs) {
    // The steepest rims are those of the highlights.
    if (auto known = at_known_size(frame, settled, locate(frame, settled).beads.size())) settled = *known;
  } else if (given.diameter_px <= 0 && model_of(settled.refine) == DiscModel::shared_profile) {
    const std::vector<Detection> beads = locate(frame, settled).beads;
    settled = at_rim(frame, std::move(settled), beads);
  }
  settled = with_spread_of_sizes(frame, with_pale_discs(frame, settled));
  const std::vector<Detection> beads = locate(frame, settled).beads;
  if (!chosen.choice.pairs) chosen.choice.apart_px = distance_of_parts(beads, settled);
  chosen.choice.one_sided = one_sided_shading(frame, beads);
  if (given.diameter_px <= 0) {
    chosen.choice.spots_px = width_of_spots(beads, settled);
    if (!chosen.choice.pairs && chosen.choice.apart_px <= 0 && chosen.choice.spots_px <= 0)
      chosen.choice.touching_px = width_by_neighbours(frame, beads, settled);
  }
  return {settled, static_cast<std::int64_t>(chosen.number), std::move(chosen.choice)};
}

/// Examines frames 0, 1, 2, 4, ... until one shows a bead with the settings found in it. The frames are few,
/// because the search in one frame takes as long as locating many frames.
LocatorConfiguration search(FramesAhead& frames, const LocatorOptions& given, int threads) {
  constexpr std::size_t kLast = 32;
  std::optional<LocatorOptions> first;  // first settings found, even if they locate no bead
  SettingsChoice refused;               // on the first frame, or on the first that shows what is not round
  for (std::size_t k = 0; k <= kLast; k = std::max<std::size_t>(2 * k, k + 1)) {
    const cv::Mat* frame = frames.look(k);
    if (frame == nullptr) break;
    if (is_blank(*frame)) continue;
    SettingsChoice choice = choose_settings(*frame, given, threads);
    if (choice.tried.empty()) {
      if (refused.refused.empty() || (not_round(refused) == nullptr && not_round(choice) != nullptr))
        refused = std::move(choice);
      continue;
    }
    const LocatorOptions settled = settled_on(*frame, choice, given);
    if (!first) first = settled;
    if (locate(*frame, settled).beads.empty()) continue;
    ChoiceOnFrame chosen = of_most_frames(frames, {k, std::move(choice)}, given, threads);
    return adapted(*frames.look(chosen.number), std::move(chosen), given);
  }
  if (!first && given.diameter_px <= 0) {
    const TriedSettings* other = not_round(refused);
    const std::string complaint =
        other == nullptr
            ? "shows no discs from which a bead diameter could be estimated; give it with --diameter."
            : fmt::format(
                  "shows no discs: what stands out is not round ({}); if it shows beads, give their "
                  "diameter with --diameter.",
                  roundness_in_words(*other));
    throw NoDiscs(Where{.file = frames.source().current(), .key = {}}, complaint, std::move(refused));
  }
  LocatorOptions found = first.value_or(given);
  found.polarity_known = true;
  return {found, 0, {}};
}

}  // namespace

LocatorConfiguration configure_locator(FramesAhead& frames, const LocatorOptions& options, int threads) {
  cv::setNumThreads(1);  // the only thread pool is that of this program
  LocatorOptions given = options;
  given.size_known = given.diameter_px > 0;
  const cv::Mat* first = frames.look(0);
  if (first == nullptr) return {given, 0, {}};
  if (given.diameter_px <= 0 || !given.polarity_known) return search(frames, given, threads);
  LocatorOptions found = given;
  found.preprocess.contrast = find_contrast(*first, given);
  return {with_spread_of_sizes(*first, with_pale_discs(*first, found)), 0, {}};
}

}  // namespace twincell::imaging
