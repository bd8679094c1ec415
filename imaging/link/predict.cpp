#include "imaging/link/predict.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "imaging/link/link_costs.hpp"

namespace twincell::imaging {

namespace {

/// Quality of fit between shifted predictions and detections: mean over the tracks of 1 - (r / 0.25 d)^2,
/// with 0 for r > 0.25 d.
double fit(const std::vector<PixelPoint>& expected, PixelPoint shift, const PointGrid& grid, double d) {
  if (expected.empty()) return 0;
  const double reach = kLinkCosts.settle_reach * d;
  double sum = 0;
  for (const PixelPoint p : expected) {
    double least = reach * reach;
    grid.within(p + shift, reach, [&](std::size_t, double r2) { least = std::min(least, r2); });
    sum += 1 - least / (reach * reach);
  }
  return sum / static_cast<double>(expected.size());
}

/// Median displacement from the predictions to the nearest detections. It is repeated `times` times; each
/// repetition searches about the predictions shifted by the previous result.
PixelPoint median_displacement(const std::vector<PixelPoint>& expected, const PointGrid& grid, double d,
                               PixelPoint shift, int times) {
  std::vector<PixelPoint> displacements;
  for (; times > 0; --times) {
    displacements.clear();
    for (const PixelPoint p : expected) {
      double least = std::numeric_limits<double>::infinity();
      std::size_t nearest = 0;
      grid.within(p + shift, kLinkCosts.lookup_reach * d, [&](std::size_t k, double r2) {
        if (r2 < least) {
          least = r2;
          nearest = k;
        }
      });
      if (std::isfinite(least)) displacements.push_back(grid[nearest] - p);
    }
    if (displacements.empty()) return shift;
    shift = median(displacements);
  }
  return shift;
}

struct Shift {
  PixelPoint px;
  bool unclear = false;  // another shift fits nearly as well
};

/// Most common displacement: the peak of the histogram of all displacements from predictions to detections
/// within reach, in cells of d/8 summed over 3 x 3 cells. Except at its rim, a crystal looks the same after a
/// shift by a lattice vector. Among peaks of nearly equal height, the weight therefore favours the one
/// nearest to `likely`.
Shift most_common_displacement(const std::vector<PixelPoint>& expected, const PointGrid& grid, double d,
                               double reach, PixelPoint likely) {
  const double cell = d / 8;
  const int half = static_cast<int>(std::ceil(reach / cell)) + 1;
  const auto n = static_cast<std::size_t>(2 * half + 1);
  std::vector<int> count(n * n);
  auto at = [&](int i, int j) {
    return static_cast<std::size_t>(j + half) * n + static_cast<std::size_t>(i + half);
  };
  auto cell_of = [&](double v) { return static_cast<int>(std::lround(v / cell)); };
  for (const PixelPoint p : expected)
    grid.within(p, reach, [&](std::size_t k, double) {
      const PixelPoint displacement = grid[k] - p;
      ++count[at(cell_of(displacement.x_px), cell_of(displacement.y_px))];
    });
  std::vector<double> sums(n * n);
  double best = 0;
  int best_i = 0, best_j = 0;
  for (int j = 1 - half; j < half; ++j)
    for (int i = 1 - half; i < half; ++i) {
      double sum = 0;
      for (int b = -1; b <= 1; ++b)
        for (int a = -1; a <= 1; ++a) sum += count[at(i + a, j + b)];
      sum *= std::exp(-0.5 * square(PixelPoint{i * cell, j * cell} - likely) /
                      (kLinkCosts.common_shift_sigma * kLinkCosts.common_shift_sigma * d * d));
      sums[at(i, j)] = sum;
      if (sum > best) {
        best = sum;
        best_i = i;
        best_j = j;
      }
    }
  if (best <= 0) return {};
  double rival = 0;
  for (int j = 1 - half; j < half; ++j)
    for (int i = 1 - half; i < half; ++i)
      if (std::max(std::abs(i - best_i), std::abs(j - best_j)) > 4) rival = std::max(rival, sums[at(i, j)]);
  return {median_displacement(expected, grid, d, {best_i * cell, best_j * cell}, 1), rival > 0.98 * best};
}

/// The tracks that were seen in the last frame, and the centre of mass of all detections, which moves with
/// the bed and has no lattice ambiguity.
struct Bed {
  std::vector<std::size_t> alive;
  bool may_shift = false;  // a common shift is searched for
  PixelPoint centre;
  /// Displacement of the centre of mass from the mean of the predictions, whose sum is given.
  [[nodiscard]] PixelPoint displacement(PixelPoint sum) const {
    return centre - (1.0 / static_cast<double>(alive.size())) * sum;
  }
};

Bed bed_of(const FrameMatch& m) {
  Bed bed;
  for (std::size_t t = 0; t < m.tracks.size(); ++t)
    if (m.tracks[t].missed == 0) bed.alive.push_back(t);
  const PointGrid& detections = m.detections;
  for (std::size_t k = 0; k < detections.size(); ++k) bed.centre = bed.centre + detections[k];
  bed.may_shift = m.options.max_shift_diameters > 0 && !bed.alive.empty() && detections.size() > 0;
  if (bed.may_shift) bed.centre = (1.0 / static_cast<double>(detections.size())) * bed.centre;
  return bed;
}

/// A rule with the common shift of its predictions, and how well both fit the frame, 0 .. 1.
struct Prediction {
  PredictionRule rule = PredictionRule::step;
  PixelPoint shift;
  double fit = -1;
};

Prediction fitted(const FrameMatch& m, const Bed& bed, PredictionRule rule) {
  const double d = m.options.diameter_px, most = m.options.max_shift_diameters;
  const std::size_t stride = std::max<std::size_t>(1, bed.alive.size() / kLinkCosts.sample_tracks);
  std::vector<PixelPoint> sample;
  PixelPoint sum;
  for (std::size_t a = 0; a < bed.alive.size(); ++a) {
    const PixelPoint p = m.before.predict(bed.alive[a], rule, m.time);
    sum = sum + p;
    if (a % stride == 0) sample.push_back(p);
  }
  PixelPoint shift;
  if (bed.may_shift) {
    shift = bed.displacement(sum);
    if (square(shift) > most * most * d * d) shift = {};
    shift = median_displacement(sample, m.detections, d, shift, 2);
  }
  return {rule, shift, fit(sample, shift, m.detections, d)};
}

/// The first rule, unless a later one fits clearly better.
Prediction best_rule(const FrameMatch& m, const Bed& bed) {
  constexpr double kMinGain = 0.03;  // of the fit, from a later rule
  std::vector<PredictionRule> rules = {PredictionRule::still, PredictionRule::step};
  if (m.before.remember(m.time)) rules.push_back(PredictionRule::cycle);
  Prediction best;
  for (const PredictionRule rule : rules) {
    const Prediction other = fitted(m, bed, rule);
    if (other.fit > best.fit + kMinGain) best = other;
    if (best.fit > kLinkCosts.good_fit) break;
  }
  return best;
}

/// For a poor fit: searches all common shifts within reach.
void search_shifts(FrameMatch& m, const Bed& bed, Prediction& best) {
  const double d = m.options.diameter_px;
  std::vector<PixelPoint> expected;
  PixelPoint sum;
  for (const std::size_t t : bed.alive) {
    expected.push_back(m.before.predict(t, best.rule, m.time));
    sum = sum + expected.back();
  }
  const Shift other = most_common_displacement(expected, m.detections, d, m.options.max_shift_diameters * d,
                                               bed.displacement(sum));
  if (fit(expected, other.px, m.detections, d) > fit(expected, best.shift, m.detections, d))
    best.shift = other.px;
  m.report.unclear_shifts += other.unclear ? 1 : 0;
}

}  // namespace

void predict(FrameMatch& m) {
  constexpr double kPoorFit = 0.5;
  constexpr double kMaxCoordinate = 1e9;  // px, beyond any camera
  const Bed bed = bed_of(m);
  Prediction best = best_rule(m, bed);
  if (bed.may_shift && best.fit < kPoorFit) search_shifts(m, bed, best);
  // Floor: the plate stops a landing bed, and its lowest row lands first.
  double floor = -kMaxCoordinate;
  for (std::size_t k = 0; k < m.detections.size(); ++k) floor = std::max(floor, m.detections[k].y_px);
  const auto above_floor = [&](PixelPoint p) { return PixelPoint{p.x_px, std::min(p.y_px, floor)}; };
  m.ballistic.resize(m.tracks.size());
  m.expected.resize(m.tracks.size());
  m.expected_no_floor.resize(m.tracks.size());
  for (std::size_t t = 0; t < m.tracks.size(); ++t) {
    m.ballistic[t] = above_floor(m.before.in_flight(t, m.options.fall_px, m.time));
    const PixelPoint p = m.tracks[t].missed == 0 ? m.before.predict(t, best.rule, m.time)
                                                 : m.tracks[t].place + m.time.interval * m.before.step;
    m.expected_no_floor[t] = p + best.shift;
    m.expected[t] = above_floor(m.expected_no_floor[t]);
  }
}

}  // namespace twincell::imaging
