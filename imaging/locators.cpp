#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <tuple>
#include <utility>

#include "analysis/trajectory/error.hpp"
#include "analysis/trajectory/median.hpp"
#include "imaging/edge_fit.hpp"
#include "imaging/hough_locator.hpp"
#include "imaging/locator.hpp"
#include "imaging/orientation.hpp"
#include "imaging/vote_locator.hpp"

namespace twincell {

namespace {

// The list of finders; the first is the default.
using Finders = std::tuple<VoteFinder, HoughFinder>;

template <class Visit>
void for_each_finder(Visit&& visit) {
  std::apply(
      [&]<CircleFinder... F>(const F&...) { (visit.template operator()<F>(), ...); }, Finders{});
}

/// By y, then x.
void sort_by_place(std::vector<Detection>& detections) {
  std::vector<std::pair<std::pair<double, double>, std::size_t>> order;
  order.reserve(detections.size());
  for (std::size_t k = 0; k < detections.size(); ++k)
    order.push_back({{detections[k].y, detections[k].x}, k});
  std::sort(order.begin(), order.end());
  std::vector<Detection> sorted;
  sorted.reserve(order.size());
  for (const auto& entry : order) sorted.push_back(detections[entry.second]);
  detections = std::move(sorted);
}

/// Gradients do not point at the centre of a large disc well enough for their votes to meet within a pixel:
/// it is sought on a smaller picture.
std::vector<Proposal> propose_at_scale(const std::string& finder, const Prepared& image,
                                       const FindOptions& wanted) {
  constexpr double kLarge = 25, kGoal = 16;  // px
  if (wanted.radius_px <= kLarge) {
    std::vector<Proposal> found = propose(finder, image, wanted);
    for (Proposal& p : found) p.radius = wanted.radius_px;
    return found;
  }
  const double shrink = wanted.radius_px / kGoal;
  Prepared small;
  small.light = image.light;
  cv::resize(image.darkness, small.darkness, {}, 1 / shrink, 1 / shrink, cv::INTER_AREA);
  if (!image.opaque.empty())
    cv::resize(image.opaque, small.opaque, small.darkness.size(), 0, 0, cv::INTER_NEAREST);
  const double by_x = static_cast<double>(image.darkness.cols) / small.darkness.cols,
               by_y = static_cast<double>(image.darkness.rows) / small.darkness.rows;
  FindOptions at = wanted;
  at.radius_px = wanted.radius_px / shrink;
  std::vector<Proposal> found = propose(finder, small, at);
  for (Proposal& p : found) {
    p.x = (p.x + 0.5) * by_x - 0.5;
    p.y = (p.y + 0.5) * by_y - 0.5;
    p.radius = wanted.radius_px;
  }
  return found;
}

class Stopwatch {
 public:
  double lap() {
    const auto now = std::chrono::steady_clock::now();
    const double seconds = std::chrono::duration<double>(now - last_).count();
    last_ = now;
    return seconds;
  }

 private:
  std::chrono::steady_clock::time_point last_ = std::chrono::steady_clock::now();
};

}  // namespace

std::vector<Proposal> propose(const std::string& finder, const Prepared& image, const FindOptions& options) {
  std::vector<Proposal> found;
  for_each_finder([&]<class F>() {
    if (F::name == finder) found = F::find(image, options);
  });
  return found;
}

std::vector<std::string> finder_names() {
  std::vector<std::string> names;
  for_each_finder([&]<class F>() { names.emplace_back(F::name); });
  return names;
}

void LocatorOptions::check() const {
  auto range = [](const char* key, double value, double lower, double upper) {
    require_range(Where{.file = {}, .key = key}, value, lower, upper);
  };
  range("diameter", diameter_px, 3, 400);
  range("min-score", find.min_score, 0.01, 1);
  for (const double other : other_diameters_px) range("diameter", other, 3, 400);
  if (!other_diameters_px.empty() && refine.method != "edges")
    throw ConfigError(Where{.file = {}, .key = "diameter"},
                      "has several values; discs of several sizes are located with --refine edges.");
  if (refine.method != "exact" && refine.method != "fast" && refine.method != "edges")
    throw ConfigError(Where{.file = {}, .key = "refine"},
                      fmt::format("is '{}'; it is \"exact\", \"fast\" or \"edges\".", refine.method));
  range("contrast", preprocess.contrast, 0.01, 2);
  range("sweeps", refine.sweeps, 1, 100);
  range("tolerance", refine.tolerance_px, 1e-9, 1);
  if (refine.ring_px != 0) range("ring", refine.ring_px, 1, 50);
  range("blur", refine.blur_px, 0, 10);
  range("radius-spread", refine.radius_spread, 1e-6, 1);
  range("radius-tolerance", judge.radius_tolerance, 0, 1);
  std::string names;
  for (const std::string& name : finder_names()) {
    if (name == finder) return;
    names += (names.empty() ? "" : ", ") + name;
  }
  throw ConfigError(Where{.file = {}, .key = "locator"},
                    fmt::format("there is no locator '{}'; there are: {}.", finder, names));
}

namespace {

/// Discs of every size asked for; those of several sizes each say which.
std::vector<Proposal> propose_all(const Prepared& image, const LocatorOptions& options) {
  FindOptions wanted = options.find;
  wanted.radius_px = options.diameter_px / 2;
  std::vector<Proposal> all = propose_at_scale(options.finder, image, wanted);
  for (const double other : options.other_diameters_px) {
    wanted.radius_px = other / 2;
    const std::vector<Proposal> more = propose_at_scale(options.finder, image, wanted);
    all.insert(all.end(), more.begin(), more.end());
  }
  return all;
}

}  // namespace

LocatorStages locate_stages(const cv::Mat& grey, const LocatorOptions& options) {
  options.check();
  if (grey.empty()) return {};
  const double radius = options.diameter_px / 2;
  LocatorStages result;
  Stopwatch watch;
  result.image = prepare(grey, options.preprocess, radius);
  result.reports.push_back({"prepare", watch.lap(), 0});
  result.proposals = propose_all(result.image, options);
  result.reports.push_back({"find", watch.lap(), result.proposals.size()});
  result.refined = options.refine.method == "edges"
                       ? refine_by_edges(result.image, result.proposals, radius)
                       : refine(result.image, result.proposals, radius, options.refine);
  result.reports.push_back({"refine", watch.lap(), result.refined.beads.size()});
  JudgeOptions judged = options.judge;
  // Patterned discs differ in brightness without being tracers.
  if (options.preprocess.contrast != 1) judged.tracer_below = 0;
  for (const double other : options.other_diameters_px) judged.other_radii_px.push_back(other / 2);
  result.judged = judge(result.refined.beads, radius, grey.cols, grey.rows, judged);
  result.reports.push_back({"judge", watch.lap(), result.judged.beads.size()});
  return result;
}

Located locate(const cv::Mat& picture, const LocatorOptions& options) {
  const Orientation way = canonical_orientation(picture);
  LocatorStages stages = locate_stages(way.turned(picture), options);
  Located result;
  result.blur_px = stages.refined.blur_px;
  result.beads = std::move(stages.judged.beads);
  result.dropped = std::move(stages.refined.dropped);
  result.dropped.insert(result.dropped.end(), stages.judged.dropped.begin(), stages.judged.dropped.end());
  for (std::vector<Detection>* list : {&result.beads, &result.dropped}) {
    for (Detection& d : *list) d = way.back(d, picture.size());
    sort_by_place(*list);
  }
  result.stages = std::move(stages.reports);
  return result;
}

double estimate_diameter(const cv::Mat& grey, const PreprocessOptions& options) {
  const double smallest = 3, largest = std::min(40.0, 0.5 * std::min(grey.cols, grey.rows));
  if (largest < smallest) return 0;
  const Prepared image = prepare(grey, options, largest);
  constexpr double kRatio = 1.03;
  std::vector<double> sharpness;
  const int steps = static_cast<int>(std::log(largest / smallest) / std::log(kRatio));
  for (int k = 0; k <= steps; ++k)
    sharpness.push_back(vote_sharpness(image.darkness, smallest * std::pow(kRatio, k)));
  const auto peak = std::max_element(sharpness.begin(), sharpness.end());
  if (*peak <= 0) return 0;
  // The top of the parabola through the best and its neighbours.
  double k = static_cast<double>(peak - sharpness.begin());
  if (peak != sharpness.begin() && peak + 1 != sharpness.end()) {
    const double curvature = peak[-1] - 2 * peak[0] + peak[1];
    if (curvature < 0) k += 0.5 * (peak[-1] - peak[1]) / curvature;
  }
  return 2 * smallest * std::pow(kRatio, k);
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
      best = FoundSettings{options.diameter_px, bright, explained, options.other_diameters_px, true};
  }
  return best;
}

std::optional<FoundSettings> find_settings(const cv::Mat& grey, const LocatorOptions& given) {
  if (given.diameter_px <= 0)
    if (auto found = find_patterned(grey, given)) return found;
  constexpr int kRounds = 4;
  constexpr double kClose = 0.01;  // relative change of the diameter at which it stands
  constexpr double kGood = 0.8;    // score of a bead that tells of its size
  constexpr std::size_t kEnough = 3;
  std::optional<FoundSettings> best;
  for (const bool bright : {false, true}) {
    if (given.polarity_known && bright != given.preprocess.bright) continue;
    LocatorOptions options = given;
    options.preprocess.bright = bright;
    options.diameter_px =
        given.diameter_px > 0 ? given.diameter_px : estimate_diameter(grey, options.preprocess);
    if (options.diameter_px < 3) continue;
    double explained = 0;
    for (int round = 0; round < kRounds; ++round) {
      std::vector<double> radii;
      explained = 0;
      for (const Detection& b : locate(grey, options).beads) {
        if (b.score < kGood) continue;
        // The logarithm of the likelihood gained. Areas times scores did not do: discs put into the gaps
        // between dark ones explain nineteen twentieths of their own rings.
        explained -= b.radius * b.radius * std::log(std::max(1 - b.score, 1e-6));
        if (!b.edge) radii.push_back(b.radius);
      }
      if (given.diameter_px > 0 || radii.size() < kEnough) break;
      const double found = std::clamp(2 * upper_median(std::move(radii)), 3.0, 400.0),
                   change = found / options.diameter_px - 1;
      options.diameter_px = found;
      if (std::abs(change) < kClose) break;
    }
    if (!best || explained > best->explained)
      best = FoundSettings{options.diameter_px, bright, explained, {}, false};
  }
  return best;
}

}  // namespace twincell
