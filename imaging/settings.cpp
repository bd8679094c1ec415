#include "imaging/settings.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <utility>

#include "analysis/trajectory/median.hpp"
#include "imaging/lattice_constant.hpp"
#include "imaging/orientation.hpp"
#include "imaging/profile_fit.hpp"
#include "imaging/vote_locator.hpp"

namespace twincell {

namespace {

/// Radii (px) at which votes meet more sharply than at those beside them, sharpest first.
std::vector<double> sharp_radii(const cv::Mat1f& darkness, double smallest, double largest) {
  constexpr double kRatio = 1.03;
  constexpr std::size_t kMost = 3;
  constexpr double kLeast = 0.1;  // of the sharpest
  std::vector<double> sharpness;
  const int steps = static_cast<int>(std::log(largest / smallest) / std::log(kRatio));
  for (int k = 0; k <= steps; ++k)
    sharpness.push_back(vote_sharpness(darkness, smallest * std::pow(kRatio, k)));
  std::vector<std::pair<double, double>> tops;
  // A rise that goes on to the last one is no top.
  for (std::size_t k = 0; k + 1 < sharpness.size(); ++k) {
    const double before = k > 0 ? sharpness[k - 1] : 0, here = sharpness[k], after = sharpness[k + 1];
    if (here <= 0 || here < before || here <= after) continue;
    // What is sharpest at the smallest radius of all may be texture: only if nothing else is.
    if (k == 0 && here < *std::max_element(sharpness.begin(), sharpness.end())) continue;
    // The top of the parabola through it and its neighbours.
    double at = static_cast<double>(k);
    const double curvature = before - 2 * here + after;
    if (k > 0 && curvature < 0) at += 0.5 * (before - after) / curvature;
    tops.emplace_back(here, smallest * std::pow(kRatio, at));
  }
  std::sort(tops.rbegin(), tops.rend());
  std::vector<double> radii;
  for (const auto& [sharp, radius] : tops)
    if (radii.size() < kMost && sharp > kLeast * tops[0].first) radii.push_back(radius);
  return radii;
}

constexpr double kSmallest = 3, kLargest = 40;  // radii, px

}  // namespace

double estimate_diameter(const cv::Mat& grey, const PreprocessOptions& options) {
  const double largest = std::min(kLargest, 0.5 * std::min(grey.cols, grey.rows));
  if (largest < kSmallest) return 0;
  const std::vector<double> radii = sharp_radii(prepare(grey, options, largest).darkness, kSmallest, largest);
  return radii.empty() ? 0 : 2 * radii[0];
}

double find_contrast(const cv::Mat& grey, const LocatorOptions& options) {
  PreprocessOptions plain = options.preprocess;
  plain.contrast = 1;
  return contrast_of(prepare(grey, plain, options.diameter_px / 2).darkness);
}

std::optional<FoundSettings> find_patterned(const cv::Mat& grey, const LocatorOptions& given) {
  constexpr double kLeast = 80, kMost = 400, kRatio = 1.04;  // px
  constexpr double kShrink = 4;
  constexpr double kApart = 1.15, kComparable = 0.7;  // of a second size: ratio to the first; sharpness
  constexpr double kCovered = 0.2;                    // share of the frame
  constexpr double kNoise = 0.035;  // of a disc's contrast: makes no edges where there are none
  constexpr double kSeen = 0.7;     // mean share of the rims
  constexpr std::ptrdiff_t kEnough = 3;
  const double largest = std::min(kMost, 0.5 * std::min(grey.cols, grey.rows));
  std::optional<FoundSettings> best;
  for (const bool bright : {false, true}) {
    if (largest < kLeast || (given.polarity_known && bright != given.preprocess.bright)) continue;
    LocatorOptions options = given;
    options.refine.method = "edges";
    options.preprocess.bright = bright;
    options.diameter_px = kLeast;
    options.preprocess.contrast = find_contrast(grey, options);
    const Prepared image = prepare(grey, options.preprocess, largest / 2);
    const Noise noise = noise_of(image.darkness);
    if (noise.dark + noise.light > kNoise * kNoise) continue;
    cv::Mat1f small;
    cv::resize(image.darkness, small, {}, 1 / kShrink, 1 / kShrink, cv::INTER_AREA);
    std::vector<std::pair<double, double>> tops;  // sharpness, diameter
    double before = 0, last = 0;
    for (double d = kLeast; d <= largest; d *= kRatio) {
      const double now = vote_sharpness(small, 0.5 * d / kShrink);
      if (last > before && last >= now) tops.emplace_back(last, d / kRatio);
      before = std::exchange(last, now);
    }
    if (tops.empty()) continue;
    std::sort(tops.rbegin(), tops.rend());
    options.diameter_px = tops[0].second;
    for (const auto& [sharp, d] : tops)
      if (options.other_diameters_px.empty() && sharp > kComparable * tops[0].first &&
          std::max(d / tops[0].second, tops[0].second / d) > kApart)
        options.other_diameters_px = {d};
    std::vector<Detection> beads = locate(grey, options).beads;
    // Each size as the median of its discs; a size of which there are hardly any is none.
    const auto settle = [&](double d) {
      std::vector<double> radii;
      for (const Detection& b : beads)
        if (std::abs(2 * b.radius / d - 1) < kApart - 1) radii.push_back(b.radius);
      return std::ssize(radii) < kEnough ? 0.0 : 2 * upper_median(std::move(radii));
    };
    const double first = settle(options.diameter_px);
    if (first == 0) continue;
    options.diameter_px = first;
    if (!options.other_diameters_px.empty()) {
      const double second = settle(options.other_diameters_px[0]);
      options.other_diameters_px.clear();
      if (second > 0) options.other_diameters_px.push_back(second);
    }
    beads = locate(grey, options).beads;
    double covered = 0, explained = 0, rims = 0;
    for (const Detection& b : beads) {
      rims += b.score;
      covered += std::numbers::pi * b.radius * b.radius;
      explained -= b.radius * b.radius * std::log(std::max(1 - b.score, 1e-6));
    }
    if (covered < kCovered * grey.cols * grey.rows || std::ssize(beads) < kEnough ||
        rims < kSeen * static_cast<double>(beads.size()))
      continue;
    if (!best || explained > best->explained)
      best = FoundSettings{options.diameter_px, bright, explained, options.other_diameters_px, "edges"};
  }
  return best;
}

namespace {

/// The part of a frame, at most `side` px wide and high, whose grey levels change most from pixel to pixel.
cv::Mat busiest(const cv::Mat& grey, int side) {
  constexpr int kBlock = 16;
  const cv::Size size(std::min(grey.cols, side), std::min(grey.rows, side));
  if (size == grey.size()) return grey;
  cv::Mat1f levels;
  grey.convertTo(levels, CV_32F);
  cv::Mat1f across, down, blocks;
  cv::Sobel(levels, across, CV_32F, 1, 0);
  cv::Sobel(levels, down, CV_32F, 0, 1);
  cv::resize(cv::abs(across) + cv::abs(down), blocks, {}, 1.0 / kBlock, 1.0 / kBlock, cv::INTER_AREA);
  cv::Mat1d sums;
  cv::integral(blocks, sums, CV_64F);
  const int wide = std::min(blocks.cols, size.width / kBlock),
            high = std::min(blocks.rows, size.height / kBlock);
  double most = -1;
  cv::Point best;
  for (int y = 0; y + high < sums.rows; ++y)
    for (int x = 0; x + wide < sums.cols; ++x) {
      const double sum = sums(y + high, x + wide) - sums(y, x + wide) - sums(y + high, x) + sums(y, x);
      if (sum > most) most = sum, best = {x, y};
    }
  best = {std::min(kBlock * best.x, grey.cols - size.width),
          std::min(kBlock * best.y, grey.rows - size.height)};
  return grey(cv::Rect(best, size)).clone();
}

struct Hypothesis {
  bool bright = false;
  double diameter_px = 0;
};

/// Sizes that the votes of one or both polarities propose, and the lattice constant; the given one where one
/// was given.
std::vector<Hypothesis> hypotheses(const cv::Mat& grey, const LocatorOptions& given, double lattice) {
  constexpr double kNoisy = 0.04, kSmooth = 1;  // darkness; px
  std::vector<Hypothesis> all;
  const double largest = std::min(kLargest, 0.5 * std::min(grey.cols, grey.rows));
  for (const bool bright : {false, true}) {
    if (given.polarity_known && bright != given.preprocess.bright) continue;
    if (given.diameter_px > 0) {
      all.push_back({bright, given.diameter_px});
      continue;
    }
    if (largest < kSmallest) continue;
    PreprocessOptions options = given.preprocess;
    options.bright = bright;
    cv::Mat1f darkness = prepare(grey, options, largest).darkness;
    // The gradients of noise alone would vote, and meet most sharply at the smallest radius.
    const Noise noise = noise_of(darkness);
    if (noise.dark + noise.light > kNoisy * kNoisy)
      cv::GaussianBlur(darkness.clone(), darkness, {0, 0}, kSmooth);
    for (const double radius : sharp_radii(darkness, kSmallest, largest)) all.push_back({bright, 2 * radius});
    if (lattice > 0) all.push_back({bright, lattice});
  }
  return all;
}

double gained(const Detection& b) {
  return -b.radius * b.radius * std::log(std::max(1 - b.score, 1e-6));
}

struct Trial {
  double explained = 0;
  double diameter_px = 0;  // median of what was found; 0: too few. Or what was settled on
};

/// Whether most discs lie too near to another one for discs of one layer, were all wider by a factor. Where
/// they are no discs of that size they explain much, of a crystal all, each with a share of its neighbours.
bool overlap(const std::vector<Detection>& beads, double wider = 1) {
  constexpr double kOverlap = 0.85;  // of R_i + R_j between centres
  std::vector<double> nearest;
  for (const Detection& b : beads) {
    double least = HUGE_VAL;
    for (const Detection& o : beads)
      if (&o != &b) {
        const double dx = o.x - b.x, dy = o.y - b.y, reach = o.radius + b.radius;
        least = std::min(least, (dx * dx + dy * dy) / (reach * reach));
      }
    nearest.push_back(std::sqrt(least));
  }
  return !nearest.empty() && upper_median(std::move(nearest)) < kOverlap * wider;
}

/// What plain discs explain. Areas times scores did not do for the sum: discs put into the gaps between dark
/// ones explain nineteen twentieths of their own rings.
Trial try_plain(const cv::Mat& grey, const LocatorOptions& options) {
  constexpr double kGood = 0.8;  // score of a bead that tells of its size
  constexpr std::size_t kEnough = 3;
  Trial trial;
  std::vector<double> radii;
  const std::vector<Detection> beads = locate(grey, options).beads;
  if (overlap(beads)) return trial;
  for (const Detection& b : beads) {
    if (b.score < kGood) continue;
    trial.explained += gained(b);
    if (!b.edge) radii.push_back(b.radius);
  }
  if (radii.size() >= kEnough) trial.diameter_px = std::clamp(2 * upper_median(std::move(radii)), 3.0, 400.0);
  return trial;
}

/// Likewise with the size that the discs found have, and so on until it stands; a given one stays.
Trial settle_plain(const cv::Mat& grey, const LocatorOptions& given, const Hypothesis& h) {
  constexpr int kTrialSweeps = 3;  // tell discs from what is none; a wrong hypothesis never settles
  constexpr int kRounds = 4;
  constexpr double kClose = 0.01;  // relative change of the diameter at which it stands
  LocatorOptions options = given;
  options.refine.sweeps = std::min(options.refine.sweeps, kTrialSweeps);
  options.preprocess.bright = h.bright;
  options.diameter_px = h.diameter_px;
  Trial trial = try_plain(grey, options);
  for (int round = 1; round < kRounds && given.diameter_px <= 0 && trial.diameter_px > 0; ++round) {
    const double change = trial.diameter_px / options.diameter_px - 1;
    options.diameter_px = trial.diameter_px;
    if (std::abs(change) < kClose) break;
    trial = try_plain(grey, options);
  }
  trial.diameter_px = options.diameter_px;
  return trial;
}

struct ProfileTrial {
  double explained = 0;
  bool overlaps = false;  // and nothing is explained
  DiscProfile profile;
};

ProfileTrial try_profile(const cv::Mat& grey, LocatorOptions options, const Hypothesis& h) {
  constexpr int kTrialSweeps = 3;
  options.refine.method = "profile";
  options.refine.sweeps = kTrialSweeps;
  options.preprocess.bright = h.bright;
  options.diameter_px = h.diameter_px;
  ProfileTrial trial;
  const LocatorStages stages = locate_stages(grey, options);
  trial.overlaps = overlap(stages.judged.beads, std::max(1.0, 2 * stages.profile.rim() / h.diameter_px));
  if (trial.overlaps) return trial;
  for (const Detection& b : stages.judged.beads) trial.explained += gained(b);
  trial.profile = stages.profile;
  return trial;
}

constexpr double kUnlike = 0.012;  // of a plain disc's profile
constexpr double kDark = 0.5;      // paler discs the plain fit calls none

bool looks_plain(const ProfileTrial& trial) {
  return trial.explained > 0 && trial.profile.unlike_plain() < kUnlike && trial.profile.largest() > kDark;
}

/// The best of the hypotheses by a common profile, each led out to the rim that its profile shows; none if
/// that is by what plain discs were found.
std::optional<FoundSettings> find_alike(const cv::Mat& frame, const LocatorOptions& given,
                                        const std::vector<Hypothesis>& all, const FoundSettings& plain,
                                        double lattice) {
  constexpr double kClearly = 1.25, kBetter = 1.1;
  constexpr double kWider = 1.12, kWiderRim = 1.05;
  constexpr int kRounds = 2;
  constexpr double kClose = 0.02, kTolerance = 0.2;  // of the diameter
  constexpr int kDiscs = 14;                         // across the part that is looked at
  constexpr double kNear = 0.15;                     // relative
  constexpr double kAsGood = 0.6;                    // a profile is freer, and what is no disc easier to miss
  double largest = plain.diameter_px;
  for (const Hypothesis& h : all) largest = std::max(largest, h.diameter_px);
  const cv::Mat grey = busiest(frame, std::clamp(static_cast<int>(kDiscs * largest), 160, 360));
  const auto allowed = [&](const Hypothesis& h) {
    return h.diameter_px >= 2 * kSmallest &&
           (given.diameter_px <= 0 || std::abs(h.diameter_px / given.diameter_px - 1) <= kTolerance) &&
           (!given.polarity_known || h.bright == given.preprocess.bright);
  };
  const auto led_out = [&](Hypothesis& h) {
    ProfileTrial trial = try_profile(grey, given, h);
    for (int round = 0; round < kRounds && trial.explained > 0; ++round) {
      const double rim = trial.profile.rim();
      const bool inverted = trial.profile.at(0.95 * rim) < 0;
      const Hypothesis next{h.bright != inverted, 2 * rim};
      if (!allowed(next) || (!inverted && std::abs(next.diameter_px / h.diameter_px - 1) < kClose)) break;
      ProfileTrial out = try_profile(grey, given, next);
      if (out.explained <= trial.explained) break;
      h = next;
      trial = std::move(out);
    }
    return trial;
  };
  // Plain discs as the profiles show them, or as wide as they lie apart. Where discs fill the frame as a
  // crystal nothing tells a profile what is disc and what is ground: it may fail at the discs, and not at the
  // gaps.
  FoundSettings as_plain;
  const auto try_as_plain = [&](const Hypothesis& h) {
    const Trial trial = settle_plain(grey, given, {h.bright, std::max(h.diameter_px, 2 * kSmallest)});
    if (trial.explained > as_plain.explained)
      as_plain = {trial.diameter_px, h.bright, trial.explained, {}, {}};
  };
  Hypothesis best{plain.bright, plain.diameter_px};
  ProfileTrial of_best = try_profile(grey, given, best);
  if (of_best.overlaps || std::abs(best.diameter_px - lattice) < kNear * lattice) try_as_plain(best);
  double to_beat = kClearly * of_best.explained;
  for (Hypothesis h : all) {
    ProfileTrial trial = led_out(h);
    if (lattice > 0 && looks_plain(trial)) try_as_plain({h.bright, 2 * trial.profile.rim()});
    if (trial.explained <= to_beat) continue;
    to_beat = trial.explained;
    best = h;
    of_best = std::move(trial);
  }
  if (of_best.explained <= 0 && as_plain.explained <= 0) return std::nullopt;
  const auto plain_does = [&] {
    return as_plain.explained > (looks_plain(of_best) ? kAsGood : 1) * of_best.explained;
  };
  if (!plain_does()) {
    // A ring may hide the one that is outside it, of which votes say nothing.
    for (const double ratio : {kWider, kWider * kWider}) {
      Hypothesis wider{best.bright, ratio * best.diameter_px};
      if (!allowed(wider)) break;
      ProfileTrial trial = led_out(wider);
      if (trial.explained <= of_best.explained || trial.profile.rim() <= kWiderRim * of_best.profile.rim())
        continue;
      best = wider, of_best = std::move(trial);
      break;
    }
    // Of discs with both dark and bright rings, what lies behind is seen more evenly by one of the
    // polarities.
    if (const Hypothesis other{!best.bright, best.diameter_px}; allowed(other)) {
      ProfileTrial trial = try_profile(grey, given, other);
      if (trial.explained > kBetter * of_best.explained &&
          std::abs(trial.profile.rim() / of_best.profile.rim() - 1) < kClose)
        best = other, of_best = std::move(trial);
    }
    for (const double d : {best.diameter_px, 2 * of_best.profile.rim()}) try_as_plain({best.bright, d});
  }
  const Hypothesis rim{best.bright, 2 * of_best.profile.rim()};
  FoundSettings found{best.diameter_px, best.bright, of_best.explained, {}, {}};
  if (plain_does()) {
    found = as_plain;
  } else if (!looks_plain(of_best)) {
    found.method = "profile";
  }
  if (found.method.empty() && found.bright == plain.bright &&
      std::abs(found.diameter_px / plain.diameter_px - 1) < kTolerance)
    return std::nullopt;
  if (!plain_does() && allowed(rim) && given.diameter_px <= 0) found.diameter_px = rim.diameter_px;
  return found;
}

}  // namespace

std::optional<FoundSettings> find_settings(const cv::Mat& picture, const LocatorOptions& given) {
  // As `locate` does, so that a turned picture has the same settings.
  const cv::Mat frame = canonical_orientation(picture).turned(picture);
  std::optional<FoundSettings> patterned;
  if (given.diameter_px <= 0) patterned = find_patterned(frame, given);
  constexpr int kSide = 600;  // px
  constexpr double kShrink = 4;
  const cv::Mat grey = busiest(frame, kSide);
  const double lattice = lattice_constant(grey);
  const std::vector<Hypothesis> all = hypotheses(grey, given, lattice);
  std::optional<FoundSettings> best;
  const auto try_all = [&](const std::vector<Hypothesis>& some) {
    for (const Hypothesis& h : some) {
      const Trial trial = settle_plain(grey, given, h);
      if (!best || trial.explained > best->explained)
        best = FoundSettings{trial.diameter_px, h.bright, trial.explained, {}, {}};
    }
  };
  try_all(all);
  if (given.diameter_px <= 0 && (!best || best->explained <= 0)) {
    // A few large discs, up to 320 px.
    cv::Mat small;
    cv::resize(grey, small, {}, 1 / kShrink, 1 / kShrink, cv::INTER_AREA);
    std::vector<Hypothesis> larger = hypotheses(small, given, 0);
    for (Hypothesis& h : larger) h.diameter_px *= kShrink;
    try_all(larger);
  }
  // Rims of large circles are seen in a packing of small discs, too, but explain less of it.
  const double part = static_cast<double>(grey.total()) / static_cast<double>(frame.total());
  if (patterned && (!best || part * patterned->explained > best->explained)) return patterned;
  if (best && given.refine.method == "exact")
    if (auto alike = find_alike(frame, given, all, *best, lattice)) return alike;
  if (best && best->explained <= 0 && given.diameter_px <= 0) return std::nullopt;
  return best;
}

}  // namespace twincell
