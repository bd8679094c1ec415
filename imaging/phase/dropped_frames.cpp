#include "imaging/phase/dropped_frames.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/constants.hpp"
#include "core/median.hpp"
#include "imaging/phase/dropped_frame_costs.hpp"

namespace twincell::imaging {

namespace {

constexpr std::size_t kMinHeights = 8;

/// z = c0 + c1 sin(omega t) + c2 cos(omega t).
struct Sine {
  double omega = 0;
  Eigen::Vector3d c = Eigen::Vector3d::Zero();
  [[nodiscard]] double at(double t) const {
    return c[0] + c[1] * std::sin(omega * t) + c[2] * std::cos(omega * t);
  }
  [[nodiscard]] double amplitude() const { return std::hypot(c[1], c[2]); }
};

using Ticks = std::vector<std::int64_t>;

/// Least squares over frames first .. last - 1, without heights farther than `farthest` from `before`.
/// \returns the root mean square deviation; infinity for too few heights
double fit(std::span<const double> z, const Ticks& t, std::size_t first, std::size_t last, Sine& sine,
           double farthest = std::numeric_limits<double>::infinity()) {
  const Sine before = sine;
  Eigen::Matrix3d normal = Eigen::Matrix3d::Zero();
  Eigen::Vector3d right = Eigen::Vector3d::Zero();
  double zz = 0, n = 0;
  for (std::size_t f = first; f < last; ++f) {
    const auto when = static_cast<double>(t[f]);
    if (!std::isfinite(z[f]) || !(std::abs(z[f] - before.at(when)) <= farthest)) continue;
    const Eigen::Vector3d b(1, std::sin(sine.omega * when), std::cos(sine.omega * when));
    normal += b * b.transpose();
    right += z[f] * b;
    zz += z[f] * z[f];
    ++n;
  }
  if (n < 6) return std::numeric_limits<double>::infinity();
  sine.c = normal.ldlt().solve(right);
  return std::sqrt(std::max(0.0, zz - sine.c.dot(right)) / n);
}

std::vector<double> deviations(std::span<const double> z, const Ticks& t, const Sine& sine) {
  std::vector<double> r;
  for (std::size_t f = 0; f < z.size(); ++f)
    if (std::isfinite(z[f])) r.push_back(std::abs(z[f] - sine.at(static_cast<double>(t[f]))));
  return r;
}

/// Negative log-likelihood of heights and ticks.
double cost_of(std::span<const double> z, const Ticks& t, const Sine& sine, double scatter) {
  double cost = 0;
  for (std::size_t f = 0; f < z.size(); ++f) {
    const double miss = std::isfinite(z[f]) ? (z[f] - sine.at(static_cast<double>(t[f]))) / scatter : 0;
    cost += std::min(0.5 * miss * miss, kMaxFrameCost);
    if (f == 0) continue;
    const std::int64_t by = t[f] - t[f - 1];
    if (by != 1)
      cost += kSlipCost + kFurtherDropCost * static_cast<double>(std::max<std::int64_t>(by - 2, 0));
  }
  return cost;
}

/// The most likely ticks, by the phase of every frame.
Ticks likeliest_ticks(std::span<const double> z, const Sine& sine, double scatter, std::size_t n) {
  std::vector<double> wave(n), cost(n, 0.0), next(n), skip(n);
  for (std::size_t k = 0; k < n; ++k) wave[k] = sine.at(static_cast<double>(k));
  std::vector<std::uint16_t> advance(z.size() * n, 1), skipped(n);
  for (std::size_t f = 1; f < z.size(); ++f) {
    // Cheapest skip of two or more ticks into each phase. Its cost grows linearly, so a running minimum
    // around the circle, twice, gives it.
    for (std::size_t k = 0; k < n; ++k) {
      skip[k] = cost[(k + n - 2) % n] + kSlipCost;
      skipped[k] = 2;
    }
    for (std::size_t round = 0; round < 2; ++round)
      for (std::size_t k = 0; k < n; ++k) {
        const std::size_t before = (k + n - 1) % n;
        if (skip[before] + kFurtherDropCost < skip[k] && skipped[before] + 1U < n) {
          skip[k] = skip[before] + kFurtherDropCost;
          skipped[k] = static_cast<std::uint16_t>(skipped[before] + 1);
        }
      }
    for (std::size_t k = 0; k < n; ++k) {
      double least = cost[(k + n - 1) % n];
      std::uint16_t by = 1;
      if (const double stay = cost[k] + kSlipCost; stay < least) least = stay, by = 0;
      if (skip[k] < least) least = skip[k], by = skipped[k];
      const double miss = std::isfinite(z[f]) ? (z[f] - wave[k]) / scatter : 0;
      next[k] = least + std::min(0.5 * miss * miss, kMaxFrameCost);
      advance[f * n + k] = by;
    }
    std::swap(cost, next);
  }
  auto k = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
  Ticks ticks(z.size());
  std::vector<std::int64_t> by(z.size(), 0);
  for (std::size_t f = z.size() - 1; f > 0; --f) {
    by[f] = advance[f * n + k];
    k = (k + n - static_cast<std::size_t>(by[f]) % n) % n;
  }
  ticks[0] = static_cast<std::int64_t>(k);
  for (std::size_t f = 1; f < z.size(); ++f) ticks[f] = ticks[f - 1] + by[f];
  return ticks;
}

double turns_of(const Sine& sine) {
  const double turns = std::atan2(sine.c[2], sine.c[1]) / kTurn;
  return turns - std::floor(turns);
}

}  // namespace

double SineSlips::at(std::size_t frame, int frames_per_cycle) const {
  return mean + amplitude * std::sin(kTurn * (static_cast<double>(ticks[frame]) / frames_per_cycle + phase));
}

double FreeSine::at(std::size_t frame) const {
  return mean + amplitude * std::sin(kTurn * (static_cast<double>(frame) / period + phase));
}

std::optional<SineSlips> fit_sine_with_slips(std::span<const double> z, int frames_per_cycle) {
  const auto n = static_cast<std::size_t>(std::max(frames_per_cycle, 0));
  SineSlips out;
  out.seen =
      static_cast<std::size_t>(std::count_if(z.begin(), z.end(), [](double v) { return std::isfinite(v); }));
  if (n < 3 || n > 65000 || z.size() < n || out.seen < kMinHeights) return std::nullopt;
  Ticks ticks(z.size());
  std::iota(ticks.begin(), ticks.end(), 0);
  Sine sine{.omega = kTurn / static_cast<double>(n)};
  const auto quiet = [&] {  // no height is far from the sine
    const std::vector<double> r = deviations(z, ticks, sine);
    return *std::max_element(r.begin(), r.end()) < 0.25 * sine.amplitude() * sine.omega;
  };
  fit(z, ticks, 0, z.size(), sine);
  if (!quiet()) {
    const Sine fixed_sine = sine;
    const Ticks fixed = ticks;
    // Start: the part that a sine fits best.
    constexpr double kPartLength = 0.6;  // cycles
    const std::size_t width = std::min(
        z.size(),
        std::max(kMinHeights, static_cast<std::size_t>(std::ceil(kPartLength * static_cast<double>(n)))));
    double least = std::numeric_limits<double>::infinity();
    Sine best = sine;
    // A plate at rest fits a sine without amplitude exactly.
    double low = kNaN, high = kNaN;  // fmin and fmax pass over heights that are not seen
    for (const double v : z) low = std::fmin(low, v), high = std::fmax(high, v);
    const double moving = 0.1 * (high - low);
    for (std::size_t first = 0; first + width <= z.size(); first += std::max<std::size_t>(1, width / 4)) {
      Sine part{.omega = sine.omega};
      // A part in which the plate hardly moves fits anything; it is judged by its share of the amplitude.
      const double off = fit(z, ticks, first, first + width, part) / std::max(part.amplitude(), 1e-9);
      if (part.amplitude() < moving) continue;
      if (off < least) least = off, best = part;
    }
    sine = best;
    double scatter = std::max(least, 0.05) * sine.amplitude();
    for (int round = 0; round < 5 && sine.amplitude() > 0; ++round) {
      ticks = likeliest_ticks(z, sine, scatter, n);
      // Frames of a plate at rest would flatten the sine.
      constexpr double kMaxFirstDeviation = 0.5;  // fraction of the amplitude, in the first round
      fit(z, ticks, 0, z.size(), sine,
          std::max(5 * scatter, round == 0 ? kMaxFirstDeviation * sine.amplitude() : 0));
      scatter = std::max(robust_spread(deviations(z, ticks, sine)), kMinScatter * sine.amplitude());
    }
    // The path starts from one part of the film, so that without slips it must not fit nearly as well.
    Sine straight = fixed_sine;
    for (int round = 0; round < 3; ++round)
      fit(z, fixed, 0, z.size(), straight,
          5 * std::max(robust_spread(deviations(z, fixed, straight)), kMinScatter * straight.amplitude()));
    if (cost_of(z, fixed, straight, scatter) <= cost_of(z, ticks, sine, scatter)) {
      ticks = fixed;
      sine = straight;
    }
  }
  out.mean = sine.c[0];
  out.amplitude = sine.amplitude();
  out.scatter = robust_spread(deviations(z, ticks, sine));
  // Phase of frame 0: the sine counts from tick 0, and frame 0 has tick ticks[0].
  const double turns =
      std::atan2(sine.c[2], sine.c[1]) / kTurn + static_cast<double>(ticks[0]) / static_cast<double>(n);
  out.phase = turns - std::floor(turns);
  for (std::size_t f = ticks.size(); f-- > 0;) ticks[f] -= ticks[0];
  for (std::size_t f = 1; f < ticks.size(); ++f) {
    const std::int64_t by = ticks[f] - ticks[f - 1];
    out.doubled += by == 0 ? 1 : 0;
    out.dropped += std::max<std::int64_t>(by - 1, 0);
  }
  out.ticks = std::move(ticks);
  return out;
}

std::optional<FreeSine> fit_free_sine(std::span<const double> all, std::optional<double> near) {
  constexpr std::size_t kSearchedFrames = 2000;
  std::span<const double> z = all.first(std::min(all.size(), kSearchedFrames));
  if (std::count_if(z.begin(), z.end(), [](double v) { return std::isfinite(v); }) <
      static_cast<std::ptrdiff_t>(kMinHeights))
    return std::nullopt;
  Ticks ticks(all.size());
  std::iota(ticks.begin(), ticks.end(), 0);
  double least = std::numeric_limits<double>::infinity();
  Sine best;
  const auto search = [&](double low, double high, double step) {
    for (double omega = low; omega < high; omega += step) {
      Sine sine{.omega = omega};
      if (const double off = fit(z, ticks, 0, z.size(), sine); off < least) least = off, best = sine;
    }
  };
  const double whole = kTurn / static_cast<double>(z.size()), step = whole / 12;
  constexpr double kReach = 1.1;  // ratio to the period that is near
  if (near)
    search(kTurn / (*near * kReach), kTurn * kReach / *near, step);
  else
    search(whole, 0.999 * std::numbers::pi, step);
  constexpr double kRefinement = 30;  // ratio of the two steps of omega
  const double found = best.omega;
  search(found - step, found + step, step / kRefinement);
  double known = step / kRefinement;
  for (; z.size() < all.size(); known /= 2) {
    z = all.first(std::min(all.size(), 2 * z.size()));
    least = std::numeric_limits<double>::infinity();
    const double middle = best.omega;
    search(middle - known, middle + known, known / 4);
  }
  // Between the steps: down to a hundredth of one.
  for (double width = known; width > known / 100; width /= 2) {
    const double middle = best.omega;
    search(middle - width / 2, middle + 0.51 * width, width / 2);
  }
  if (!(best.omega > 0)) return std::nullopt;
  return FreeSine{kTurn / best.omega, best.amplitude(), robust_spread(deviations(z, ticks, best)), best.c[0],
                  turns_of(best)};
}

std::vector<int> frames_per_cycle_to_try(int stated, double apparent_period) {
  constexpr std::size_t kMaxTrials = 23;
  if (stated != 0) return {stated};
  std::vector<int> all;
  const int last = static_cast<int>(1.3 * apparent_period) + 1;
  for (int n = std::max(3, static_cast<int>(0.85 * apparent_period)); n <= last && all.size() < kMaxTrials;
       ++n)
    all.push_back(n);
  return all;
}

}  // namespace twincell::imaging
