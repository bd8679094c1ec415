#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
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
  if (refine.method != "exact" && refine.method != "fast" && refine.method != "edges")
    throw ConfigError(Where{.file = {}, .key = "refine"},
                      fmt::format("is '{}'; it is \"exact\", \"fast\" or \"edges\".", refine.method));
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

LocatorStages locate_stages(const cv::Mat& grey, const LocatorOptions& options) {
  options.check();
  if (grey.empty()) return {};
  const double radius = options.diameter_px / 2;
  LocatorStages result;
  Stopwatch watch;
  result.image = prepare(grey, options.preprocess, radius);
  result.reports.push_back({"prepare", watch.lap(), 0});
  FindOptions wanted = options.find;
  wanted.radius_px = radius;
  result.proposals = propose(options.finder, result.image, wanted);
  result.reports.push_back({"find", watch.lap(), result.proposals.size()});
  result.refined = options.refine.method == "edges"
                       ? refine_by_edges(result.image, result.proposals, radius)
                       : refine(result.image, result.proposals, radius, options.refine);
  result.reports.push_back({"refine", watch.lap(), result.refined.beads.size()});
  result.judged = judge(result.refined.beads, radius, grey.cols, grey.rows, options.judge);
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

std::optional<FoundSettings> find_settings(const cv::Mat& grey, const LocatorOptions& given) {
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
    if (!best || explained > best->explained) best = FoundSettings{options.diameter_px, bright, explained};
  }
  return best;
}

}  // namespace twincell
