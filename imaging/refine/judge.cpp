#include "imaging/refine/judge.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <utility>

#include "core/median.hpp"
#include "imaging/refine/sparse_gauss_newton.hpp"

namespace twincell::imaging {

namespace {

Verdict verdict_on(const Detection& b, double radius_px, int width, int height, const JudgeOptions& o) {
  if (!std::isfinite(b.x) || !std::isfinite(b.y)) return Verdict::unexplained;
  const auto near = [&](double radius) { return std::abs(b.radius - radius) <= kRadiusTolerance * radius; };
  if (!near(radius_px) && std::none_of(o.other_radii_px.begin(), o.other_radii_px.end(), near))
    return Verdict::wrong_radius;
  // The inside of a pale disc is as pale as its rim; that of a void is brighter.
  constexpr double kAsDarkAsRim = 0.7;
  const double least = o.pale ? std::min(o.min_interior, kAsDarkAsRim * b.darkness) : o.min_interior;
  if (b.interior < least) return Verdict::bright_inside;
  if (b.score < o.min_score) return Verdict::unexplained;
  if (b.x < -0.5 || b.y < -0.5 || b.x >= width - 0.5 || b.y >= height - 0.5) return Verdict::outside;
  return Verdict::bead;
}

// Two opaque discs cannot overlap: of an overlapping pair, the better explained one is kept.
void forbid_overlaps(std::vector<Detection>& beads, double max_overlap) {
  std::vector<Disc> discs;
  discs.reserve(beads.size());
  for (const Detection& b : beads) discs.push_back({b.x, b.y, b.radius, 1});
  struct Clash {
    std::size_t better, lesser;
  };
  std::vector<Clash> clashes;
  for (const auto& [i, j] : near_pairs(discs, 0)) {
    auto better = static_cast<std::size_t>(i), lesser = static_cast<std::size_t>(j);
    const Detection &a = beads[better], &b = beads[lesser];
    const double touch = a.radius + b.radius;
    if (std::hypot(a.x - b.x, a.y - b.y) >= touch - max_overlap * std::min(a.radius, b.radius)) continue;
    if (b.score > a.score) std::swap(better, lesser);
    clashes.push_back({better, lesser});
  }
  // Best first, so that a dropped disc does not drop others.
  std::sort(clashes.begin(), clashes.end(), [&](const Clash& a, const Clash& b) {
    return std::pair(-beads[a.better].score, a.lesser) < std::pair(-beads[b.better].score, b.lesser);
  });
  for (const Clash& c : clashes)
    if (beads[c.better].verdict == Verdict::bead) beads[c.lesser].verdict = Verdict::overlaps;
}

/// Number of the smallest values that are a population of their own; 0 if none are. Below an exponential tail
/// of scale s, the gaps above the i smallest values, times i, are independent and exponential with scale s
/// (Renyi, Acta Math. Hung. 4, 191 (1953)). So with e the sum of i times gap over the m gaps between gap k
/// and the median, gap k exceeds g with the probability (1 + k g/e)^-m. Tails of log-concave distributions
/// are lighter. The gap is accepted if this is below kFalseAlarm/(k (k + 1)), of which the sum over all k is
/// kFalseAlarm. \param sorted ascending; \param limit only values below it may be split off
std::size_t separate_population(const std::vector<double>& sorted, double limit) {
  constexpr double kFalseAlarm = 1e-3;  // per frame
  constexpr double kMinScale = 0.005;   // as real pictures have
  const std::size_t middle = sorted.size() / 2;
  std::size_t split = 0;
  double sum = 0;
  for (std::size_t k = middle; k > 0; --k) {
    const auto m = static_cast<double>(middle - k), below = static_cast<double>(k);
    const double gap = below * (sorted[k] - sorted[k - 1]);
    if (sorted[k - 1] < limit && split == 0) {
      const double x = gap / std::max(sum, kMinScale * std::max(1.0, m));
      if (std::pow(1 + x, -m) * below * (below + 1) < kFalseAlarm) split = k;
    }
    sum += gap;
  }
  return split;
}

/// Flags beads that overlap another one by more than discs of one layer do.
void flag_overlaps(std::vector<Detection>& beads) {
  const double one_layer = JudgeOptions{}.max_overlap;
  std::vector<Disc> discs;
  discs.reserve(beads.size());
  for (const Detection& b : beads) discs.push_back({b.x, b.y, b.radius, 1});
  for (const auto& [i, j] : near_pairs(discs, 0)) {
    Detection &a = beads[static_cast<std::size_t>(i)], &b = beads[static_cast<std::size_t>(j)];
    if (std::hypot(a.x - b.x, a.y - b.y) < a.radius + b.radius - one_layer * std::min(a.radius, b.radius))
      a.overlap = b.overlap = true;
  }
}

/// The limit below which the interiors, times `sign`, are those of a population of their own: at most
/// `limit`. \returns nothing if there is none
std::optional<double> limit_of_population(const std::vector<double>& interior, double sign, double limit) {
  std::vector<double> sorted;
  sorted.reserve(interior.size());
  for (const double v : interior) sorted.push_back(sign * v);
  std::sort(sorted.begin(), sorted.end());
  // The limit lies below the other beads, and in or above the gap.
  const std::size_t split = separate_population(sorted, limit);
  if (split == 0) return std::nullopt;
  return std::min(limit, sorted[split]);
}

void flag_tracers(std::vector<Detection>& beads, double below) {
  if (beads.empty()) return;
  std::vector<double> interior;
  interior.reserve(beads.size());
  for (const Detection& b : beads) interior.push_back(b.interior);
  const double typical = upper_median(interior);
  double sign = 1, limit = below * typical;
  std::optional<double> found = limit_of_population(interior, sign, limit);
  // Among opaque beads tracers are paler. Among beads that let light through they may be darker instead.
  if (!found && below > 0)
    if (const auto darker = limit_of_population(interior, -1, -typical / below)) sign = -1, found = darker;
  if (found) limit = *found;
  constexpr double kMinScatter = 0.005;
  const double scatter = std::max(kMinScatter, robust_spread(std::move(interior), typical));
  for (Detection& b : beads) {
    b.tracer = found && sign * b.interior < limit;
    b.tracer_margin = std::abs(sign * b.interior - limit) / scatter;
  }
}

}  // namespace

std::string_view word_of(Verdict verdict) {
  return row_of(kVerdicts, verdict).word;
}

Judged judge(std::vector<Detection> candidates, double radius_px, int width, int height,
             const JudgeOptions& options) {
  Judged judged;
  for (Detection& b : candidates) b.verdict = verdict_on(b, radius_px, width, height, options);
  std::vector<Detection> possible;
  possible.reserve(candidates.size());
  judged.beads.reserve(candidates.size());
  for (const Detection& b : candidates)
    if (b.verdict == Verdict::bead)
      possible.push_back(b);
    else
      judged.dropped.push_back(b);
  forbid_overlaps(possible, options.max_overlap);
  for (Detection& b : possible) {
    b.edge = b.x - b.radius < -0.5 || b.y - b.radius < -0.5 || b.x + b.radius > width - 0.5 ||
             b.y + b.radius > height - 0.5;
    (b.verdict == Verdict::bead ? judged.beads : judged.dropped).push_back(b);
  }
  if (options.max_overlap > JudgeOptions{}.max_overlap) flag_overlaps(judged.beads);
  flag_tracers(judged.beads, options.tracer_below);
  return judged;
}

}  // namespace twincell::imaging
