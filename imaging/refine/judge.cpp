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
  const auto near = [&](double radius) { return std::abs(b.radius - radius) <= o.radius_tolerance * radius; };
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

/// Beads whose interiors, times `sign`, are below a limit: a population of their own.
struct Population {
  double sign = 1, limit = 0;
  std::vector<std::size_t> members;
};

/// The beads that are a population of their own, with a limit of at most `limit`; nothing if there are none.
std::optional<Population> own_population(const std::vector<Detection>& beads, double sign, double limit) {
  std::vector<double> sorted;
  sorted.reserve(beads.size());
  for (const Detection& b : beads) sorted.push_back(sign * b.interior);
  std::sort(sorted.begin(), sorted.end());
  // The limit lies below the other beads, and in or above the gap.
  const std::size_t split = separate_population(sorted, limit);
  if (split == 0) return std::nullopt;
  Population own{sign, std::min(limit, sorted[split]), {}};
  for (std::size_t k = 0; k < beads.size(); ++k)
    if (sign * beads[k].interior < own.limit) own.members.push_back(k);
  return own;
}

/// Whether the members of a population are alike: they scatter by less than half of the gap to the others.
bool are_alike(const std::vector<Detection>& beads, const Population& own) {
  constexpr double kGaps = 0.5;
  std::vector<double> interior;
  for (const std::size_t k : own.members) interior.push_back(own.sign * beads[k].interior);
  const double most = *std::max_element(interior.begin(), interior.end()), middle = upper_median(interior);
  return robust_spread(std::move(interior), middle) < kGaps * (own.limit - most);
}

/// Whether the members of a population are scattered among the others. Beads in a shadow, or along a wall,
/// are together: the nearest neighbours of more of them are members than of beads chosen at random, by at
/// least four standard deviations.
bool are_scattered(const std::vector<Detection>& beads, const Population& own) {
  constexpr std::size_t kMost = 200;  // members whose neighbours are searched
  constexpr double kDeviations = 4;
  std::vector<bool> is_member(beads.size(), false);
  for (const std::size_t k : own.members) is_member[k] = true;
  const std::size_t stride = 1 + own.members.size() / kMost;
  double asked = 0, together = 0;
  for (std::size_t m = 0; m < own.members.size(); m += stride) {
    const Detection& b = beads[own.members[m]];
    double least = HUGE_VAL;
    std::size_t nearest = 0;
    for (std::size_t k = 0; k < beads.size(); ++k) {
      const double apart = std::hypot(beads[k].x - b.x, beads[k].y - b.y);
      if (k != own.members[m] && apart < least) least = apart, nearest = k;
    }
    ++asked, together += is_member[nearest] ? 1 : 0;
  }
  const double share = static_cast<double>(own.members.size()) / static_cast<double>(beads.size());
  return together <= asked * share + kDeviations * std::sqrt(asked * share * (1 - share));
}

/// A population that differs too little from the others for a few beads of it to be believed: at least five,
/// but not more than a quarter of the beads, that are alike and scattered among the others.
std::optional<Population> close_population(const std::vector<Detection>& beads, double sign, double limit) {
  constexpr std::size_t kMinMembers = 5, kMinOthers = 3;  // the latter for each member
  std::optional<Population> own = own_population(beads, sign, limit);
  if (!own || own->members.size() < kMinMembers || (1 + kMinOthers) * own->members.size() > beads.size() ||
      !are_alike(beads, *own) || !are_scattered(beads, *own))
    return std::nullopt;
  return own;
}

/// The tracers among the beads; nothing if there are none.
std::optional<Population> find_tracers(const std::vector<Detection>& beads, double typical,
                                       const JudgeOptions& options) {
  const double below = options.tracer_below, close = options.close_tracer_below;
  if (below <= 0) return std::nullopt;
  std::optional<Population> found = own_population(beads, 1, below * typical);
  // Among opaque beads tracers are paler. Among beads that let light through they may be darker instead.
  if (!found) found = own_population(beads, -1, -typical / below);
  // Small beads let more light through than large ones.
  if (!options.other_radii_px.empty()) return found;
  std::optional<Population> near = close_population(beads, 1, close * typical);
  if (!near) near = close_population(beads, -1, -typical / close);
  // A few dirty beads are no reason to miss the tracers.
  constexpr std::size_t kMany = 3;
  return near && (!found || near->members.size() > kMany * found->members.size()) ? near : found;
}

void flag_tracers(std::vector<Detection>& beads, const JudgeOptions& options) {
  if (beads.empty()) return;
  std::vector<double> interior;
  interior.reserve(beads.size());
  for (const Detection& b : beads) interior.push_back(b.interior);
  const double typical = upper_median(interior);
  const std::optional<Population> tracers = find_tracers(beads, typical, options);
  const double sign = tracers ? tracers->sign : 1,
               limit = tracers ? tracers->limit : options.tracer_below * typical;
  constexpr double kMinScatter = 0.005;
  const double scatter = std::max(kMinScatter, robust_spread(std::move(interior), typical));
  for (Detection& b : beads) {
    b.tracer = tracers && sign * b.interior < limit;
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
  flag_tracers(judged.beads, options);
  return judged;
}

}  // namespace twincell::imaging
