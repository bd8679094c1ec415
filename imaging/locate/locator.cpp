#include "imaging/locate/locator.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>
#include <optional>
#include <utility>

#include "core/cancellation.hpp"
#include "core/choice.hpp"
#include "core/error.hpp"
#include "core/median.hpp"
#include "imaging/locate/picture_orientation.hpp"
#include "imaging/refine/outlier_discs.hpp"
#include "imaging/refine/size_assignment.hpp"

namespace twincell::imaging {

namespace {

/// Sorts by y, then x.
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

/// Gradients do not point at the centre of a large disc accurately enough for their votes to meet within a
/// pixel, so large discs are searched on a reduced picture.
std::vector<Proposal> propose_at_scale(const std::string& finder, const Prepared& image,
                                       const FindOptions& wanted) {
  constexpr double kLarge = 25, kGoal = 16;  // px
  if (wanted.radius_px <= kLarge) {
    std::vector<Proposal> found = propose(finder, image, wanted);
    for (Proposal& p : found) p.radius = wanted.radius_px;
    return found;
  }
  const double shrink = wanted.radius_px / kGoal;
  if (std::min(image.darkness.cols, image.darkness.rows) < shrink)
    return {};  // the reduced picture would be empty
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

std::vector<double> LocatorOptions::radii_px() const {
  std::vector<double> radii = {0.5 * diameter_px};
  for (const double other : other_diameters_px) radii.push_back(0.5 * other);
  return radii;
}

void LocatorOptions::check() const {
  auto range = [](const char* key, double value, double lower, double upper) {
    require_range(Where{.file = {}, .key = key}, value, lower, upper);
  };
  range("--diameter", diameter_px, 3, 400);
  range("--min-score", find.min_score, 0.01, 1);
  for (auto other = other_diameters_px.begin(); other != other_diameters_px.end(); ++other) {
    range("--diameter", *other, 3, 400);
    if (*other == diameter_px || std::find(other_diameters_px.begin(), other, *other) != other)
      throw ConfigError(Where{.file = {}, .key = "--diameter"}, fmt::format("has {} px twice.", *other));
  }
  if (!other_diameters_px.empty() && model_of(refine) == DiscModel::shared_profile)
    throw ConfigError(Where{.file = {}, .key = "--diameter"},
                      "has several values; discs of several sizes have no common profile.");
  (void)refiner_named(refine.method);
  range("preprocess.contrast", preprocess.contrast, 0.01, 2);
  range("refine.sweeps", refine.sweeps, 1, 100);
  if (refine.ring_px != 0) range("refine.ring_px", refine.ring_px, 1, 50);
  range("refine.blur_px", refine.blur_px, 0, 10);
  range("--min-explained", judge.min_score, 0, 1);
  const std::vector<std::string> finders = finder_names();
  if (std::find(finders.begin(), finders.end(), finder) == finders.end())
    refuse_word("locator", "locator", finder, finders);
}

namespace {

/// Proposals for discs of all requested sizes, each with the radius it was found with.
std::vector<Proposal> propose_all(const Prepared& image, const LocatorOptions& options) {
  // Discs of the circle model are fitted independently, so the judge chooses among overlapping ones.
  const bool choose = !options.other_diameters_px.empty() && model_of(options.refine) != DiscModel::circle;
  FindOptions wanted = options.find;
  // A proposal of the wrong size must not suppress its neighbours.
  constexpr double kApart = 0.2;
  const bool layers = refiner_named(options.refine.method).layers;
  if (choose || layers) wanted.apart = kApart;
  wanted.radius_px = options.diameter_px / 2;
  std::vector<Proposal> all = propose_at_scale(options.finder, image, wanted);
  for (const double other : options.other_diameters_px) {
    wanted.radius_px = other / 2;
    const std::vector<Proposal> more = propose_at_scale(options.finder, image, wanted);
    all.insert(all.end(), more.begin(), more.end());
  }
  return choose && !layers ? assign_sizes(image, all) : all;
}

/// Scales the radii so that a disc as large as the profile has the radius of the profile's rim. Discs of
/// another size than the known one are rejected.
void stretch_to_rim(Judged& judged, const DiscProfile& profile, bool size_known) {
  const double of_known = size_known ? profile.rim_of_known() : 0,
               rim = of_known > 0 ? of_known : profile.rim();
  if (!(rim > 0)) return;
  for (Detection& b : judged.beads) {
    b.radius *= rim / profile.radius_px;
    b.sigma_radius *= rim / profile.radius_px;
  }
  if (!size_known || of_known > 0) return;
  for (Detection& b : judged.beads) {
    b.verdict = Verdict::wrong_radius;
    judged.dropped.push_back(b);
  }
  judged.beads.clear();
}

double largest_radius(const LocatorOptions& options) {
  double diameter = options.diameter_px;
  for (const double other : options.other_diameters_px) diameter = std::max(diameter, other);
  return diameter / 2;
}

/// What locate() returns of the stages. \param size of the picture as it is stored
Located turned_back(LocatorStages stages, const PictureOrientation& orientation, cv::Size size) {
  Located result;
  result.blur_px = stages.refined.blur_px;
  result.path_px = orientation.back(stages.refined.path_px);
  if (const DiscProfile& profile = stages.refined.profile; profile.radius_px > 0 && profile.rim() > 0)
    result.rim = profile.rim() / profile.radius_px;
  result.beads = std::move(stages.judged.beads);
  result.dropped = std::move(stages.refined.dropped);
  result.dropped.insert(result.dropped.end(), stages.judged.dropped.begin(), stages.judged.dropped.end());
  for (std::vector<Detection>* list : {&result.beads, &result.dropped}) {
    for (Detection& d : *list) d = orientation.back(d, size);
    sort_by_place(*list);
  }
  result.stages = std::move(stages.reports);
  return result;
}

}  // namespace

LocatorStages locate_stages(const cv::Mat& grey, const LocatorOptions& options) {
  options.check();
  if (grey.empty()) return {};
  const double radius = options.diameter_px / 2;
  LocatorStages result;
  Stopwatch watch;
  throw_if_cancelled();
  RefineOptions refined = options.refine;
  for (const double other : options.other_diameters_px) refined.other_radii_px.push_back(other / 2);
  result.image = prepare(grey, options.preprocess, largest_radius(options));
  result.reports.push_back({"prepare", watch.lap(), 0});
  throw_if_cancelled();
  result.proposals = propose_all(result.image, options);
  result.reports.push_back({"find", watch.lap(), result.proposals.size()});
  throw_if_cancelled();
  const Refiner& refiner = refiner_named(options.refine.method);
  result.refined = refiner.fit(result.image, result.proposals, radius, refined);
  result.reports.push_back({"refine", watch.lap(), result.refined.beads.size()});
  JudgeOptions judged = options.judge;
  // Patterned discs differ in brightness without being tracers.
  if (refiner.model == DiscModel::shared_profile ||
      (refiner.model == DiscModel::circle && options.preprocess.contrast != 1))
    judged.tracer_below = 0;
  // With a shared profile the interior of a disc may have any darkness.
  if (refiner.model == DiscModel::shared_profile) judged.min_interior = -HUGE_VAL;
  // Of two discs of different layers, nearly all of one may be hidden.
  constexpr double kBehind = 1.75;
  if (refiner.layers) judged.max_overlap = kBehind;
  judged.other_radii_px = refined.other_radii_px;
  judged.pale = options.refine.pale;
  result.judged = judge(result.refined.beads, radius, grey.cols, grey.rows, judged);
  if (judged.drop_outliers && may_have_outliers(result.judged.beads)) {
    const std::vector<Detection> outliers =
        drop_outliers(grey, result.judged.beads, result.judged.dropped, radius);
    result.judged.dropped.insert(result.judged.dropped.end(), outliers.begin(), outliers.end());
  }
  if (options.rim_radii && refiner.model == DiscModel::shared_profile)
    stretch_to_rim(result.judged, result.refined.profile, options.size_known);
  result.reports.push_back({"judge", watch.lap(), result.judged.beads.size()});
  return result;
}

Located locate(const cv::Mat& picture, const LocatorOptions& options) {
  const PictureOrientation orientation = canonical_picture_orientation(picture);
  return turned_back(locate_stages(orientation.turned(picture), options), orientation, picture.size());
}

LocatedBetweenWalls locate_between_walls(const cv::Mat& picture, const LocatorOptions& options) {
  const PictureOrientation orientation = canonical_picture_orientation(picture);
  LocatorStages stages = locate_stages(orientation.turned(picture), options);
  LocatedBetweenWalls result;
  if (!orientation.turns())
    result.walls = stages.image.opaque;
  else if (!picture.empty())
    result.walls = prepare(picture, options.preprocess, largest_radius(options)).opaque;
  result.located = turned_back(std::move(stages), orientation, picture.size());
  return result;
}

}  // namespace twincell::imaging
