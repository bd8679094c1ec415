#include "imaging/phase/phase_estimation.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>

#include "core/median.hpp"
#include "imaging/phase/dropped_frame_costs.hpp"

namespace twincell::imaging {

namespace {

constexpr std::size_t kMaxLags = 2000;
constexpr std::size_t kMaxFrames = 20000;    // used for the period; the phases are estimated for all frames
constexpr double kPeriodDip = 0.2;           // largest normalised difference at a period
constexpr double kPeriodDipOfMedian = 0.03;  // the same for its median, which falls sooner
constexpr double kGivenPeriodDip = 0.8;      // the same for a given period
constexpr std::size_t kMaxDropped = 20;      // in a row
constexpr double kMaxLogOdds = 40;           // beyond the evidence of any picture, treated as certainty

/// Rise of the bed since the previous frame, for each frame; 0 for the first. Steps are used because their
/// errors are independent and free of drift, whereas the errors of heights accumulate.
using Steps = std::vector<double>;

Steps steps_of(std::span<const double> heights) {
  Steps steps(heights.size(), 0.0);
  for (std::size_t f = 1; f < heights.size(); ++f) steps[f] = heights[f] - heights[f - 1];
  return steps;
}

/// Window of `width` values about frame f; at the ends of the series it is shifted inwards.
std::span<const double> around(std::span<const double> values, std::size_t f, std::size_t width) {
  const std::size_t whole = std::min(width, values.size());
  const std::size_t first = f >= width / 2 ? f - width / 2 : 0;
  return values.subspan(std::min(first, values.size() - whole), whole);
}

/// Heights without their drift. The drift is the running median, over one cycle about each frame, of the
/// difference between heights and wave form. Gaps and misplaced frames do not change the median, and a jump
/// stays between two frames.
std::vector<double> without_drift(std::span<const double> h, std::span<const double> wave,
                                  std::span<const std::int64_t> ticks) {
  std::vector<double> off(h.begin(), h.end()), out(off);
  for (std::size_t f = 0; f < h.size(); ++f) off[f] -= wave[static_cast<std::size_t>(ticks[f]) % wave.size()];
  for (std::size_t f = 0; f < h.size(); ++f) {
    const auto cycle = around(off, f, wave.size());
    out[f] -= upper_median(std::vector<double>(cycle.begin(), cycle.end()));
  }
  return out;
}

/// Mean or median squared difference at each lag, divided by its mean over all lags up to this one.
std::vector<double> normalised_difference(std::span<const double> v, std::size_t lags, bool of_median) {
  std::vector<double> out(lags + 1, 1), squares;
  double sum = 0;
  for (std::size_t lag = 1; lag <= lags; ++lag) {
    squares.clear();
    for (std::size_t f = lag; f < v.size(); ++f) squares.push_back((v[f] - v[f - lag]) * (v[f] - v[f - lag]));
    const double typical = of_median ? upper_median(squares)
                                     : std::accumulate(squares.begin(), squares.end(), 0.0) /
                                           static_cast<double>(squares.size());
    sum += typical;
    out[lag] = sum > 0 ? typical * static_cast<double>(lag) / sum : 1;
  }
  return out;
}

/// Lag of the first minimum below `deep`; 0: no such minimum.
std::size_t first_dip(std::span<const double> dip, double deep) {
  for (std::size_t lag = 2; lag + 1 < dip.size(); ++lag)
    if (dip[lag] < deep && dip[lag] <= dip[lag + 1] && dip[lag] <= dip[lag - 1]) return lag;
  return 0;
}

/// Candidates for the period, in frames.
/// \param at_rest the bed does not move
std::vector<std::size_t> likely_periods(const Steps& steps, int given, bool at_rest) {
  auto refuse = [](const std::string& why) {
    throw InputError(Where{.file = {}, .key = "--phase-lock"},
                     why + "; give --phase-lock N or a list of triggers instead.");
  };
  const std::string does_not_repeat = at_rest
                                          ? "the bed is at rest, its mean height changes by less than 0.02 "
                                            "bead diameters, and a bed at rest shows no phases"
                                          : "the bed's motion does not repeat itself";
  constexpr std::size_t kMinPeriod = 3;  // frames
  const std::string too_few = "a cycle has fewer than three frames";
  if (given > 0 && static_cast<std::size_t>(given) < kMinPeriod) refuse(too_few);
  const std::size_t n = std::min(steps.size(), kMaxFrames);
  if (n < 9 || (given > 0 && n < 3 * static_cast<std::size_t>(given)))
    refuse(fmt::format("{} frames are too few to contain three cycles", steps.size()));
  const std::span<const double> v = std::span(steps).subspan(1, n - 1);
  const std::size_t lags = std::min(kMaxLags, v.size() / 2);
  const std::vector<double> mean = normalised_difference(v, lags, false),
                            median = normalised_difference(v, lags, true);
  if (given > 0) {
    const auto period = static_cast<std::size_t>(given);
    if (period >= lags || std::min(mean[period], median[period]) > kGivenPeriodDip)
      refuse(at_rest ? does_not_repeat : fmt::format("{} after {} frames", does_not_repeat, given));
    return {period};
  }
  std::vector<std::size_t> periods;
  const std::size_t of_mean = first_dip(mean, kPeriodDip), of_median = first_dip(median, kPeriodDipOfMedian);
  if (of_mean >= kMinPeriod) periods.push_back(of_mean);
  if (of_median >= kMinPeriod && of_median != of_mean) periods.push_back(of_median);
  if (periods.empty()) refuse(of_mean + of_median > 0 ? too_few : does_not_repeat);
  return periods;
}

/// Cost of advancing by `steps` phases to phase k in frame f.
class SlipCosts {
 public:
  /// \param repeats as BedMotion::repeats
  /// \param usual the median of the same over the cycles, for each phase
  SlipCosts(std::span<const double> repeats, std::span<const double> usual)
      : repeats_(repeats), usual_(usual) {}
  [[nodiscard]] double operator()(std::size_t f, std::size_t k, std::size_t steps) const {
    const double repeats = repeats_.empty() ? 0 : repeats_[f];
    // If the alternative move looks like a repetition in every cycle, a repetition is not evidence.
    const bool is_evidence = repeats < 0 || usual_[steps == 0 ? (k + 1) % usual_.size() : k] < 0;
    if (steps == 0) return std::max(0.0, kSlipCost - (is_evidence ? repeats : 0));
    const double moved = is_evidence ? std::max(0.0, repeats) : 0;
    return moved + (steps > 1 ? kSlipCost + kFurtherDropCost * static_cast<double>(steps - 2) : 0);
  }

 private:
  std::span<const double> repeats_, usual_;
};

struct Path {
  std::vector<std::int64_t> ticks;  // phases, counted continuously through all cycles
  double cost;                      // negative log-likelihood
};

/// Viterbi search for the most likely path.
/// \param wave usual step into each phase
/// \param scatter scatter of the steps into each phase
/// \param sigma scatter common to all steps
Path likeliest_path(const Steps& steps, std::span<const double> wave, std::span<const double> scatter,
                    double sigma, const SlipCosts& slip_cost) {
  // Weights: deviations of one cycle from another last for several frames, so frames are not independent.
  constexpr double kIndependent = 20;  // independent frames in a cycle
  const std::size_t n = wave.size(), most = std::min(kMaxDropped + 1, n - 1);
  const double independent = std::min(1.0, kIndependent / static_cast<double>(n));
  std::vector<double> weight(n), constant(n);
  for (std::size_t k = 0; k < n; ++k) {
    const double variance = sigma * sigma + scatter[k] * scatter[k];
    weight[k] = independent * 0.5 / variance;
    constant[k] = independent * 0.5 * std::log(variance / (sigma * sigma));
  }
  std::vector<double> expected(n * (most + 1), 0.0);  // step over so many phases at once
  for (std::size_t k = 0; k < n; ++k)
    for (std::size_t s = 1; s <= most; ++s)
      expected[k * (most + 1) + s] = expected[k * (most + 1) + s - 1] + wave[(k + n - (s - 1)) % n];
  std::vector<double> cost(n, 0.0), next(n);
  std::vector<std::uint8_t> passed(steps.size() * n, 1);
  for (std::size_t f = 1; f < steps.size(); ++f) {
    for (std::size_t k = 0; k < n; ++k) {
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t s = 0; s <= most; ++s) {
        const double miss = steps[f] - expected[k * (most + 1) + s];
        // The cost of a deviation is capped, so that one outlier frame cannot cause a slip.
        const double c = cost[(k + n - s) % n] + slip_cost(f, k, s) + constant[k] +
                         std::min(weight[k] * miss * miss, 0.8 * kSlipCost);
        if (c >= least) continue;
        least = c;
        passed[f * n + k] = static_cast<std::uint8_t>(s);
      }
      next[k] = least;
    }
    std::swap(cost, next);
  }
  // Backtracking from the cheapest last phase.
  auto k = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
  Path path{std::vector<std::int64_t>(steps.size()), cost[k]};
  std::vector<std::uint8_t> advance(steps.size(), 0);
  for (std::size_t f = steps.size() - 1; f > 0; --f) {
    advance[f] = passed[f * n + k];
    k = (k + n - advance[f]) % n;
  }
  path.ticks[0] = static_cast<std::int64_t>(k);
  for (std::size_t f = 1; f < steps.size(); ++f) path.ticks[f] = path.ticks[f - 1] + advance[f];
  return path;
}

/// Sets `wave` to the median at each phase, so that one damaged cycle among three does no harm. A phase
/// without frames keeps its value.
/// \param counts predicate: which frames are used
template <class Counts>
void learn(std::span<const double> values, std::span<const std::int64_t> ticks, std::vector<double>& wave,
           Counts&& counts) {
  std::vector<std::vector<double>> seen(wave.size());
  for (std::size_t f = 0; f < values.size(); ++f)
    if (counts(f)) seen[static_cast<std::size_t>(ticks[f]) % wave.size()].push_back(values[f]);
  for (std::size_t k = 0; k < wave.size(); ++k) {
    if (seen[k].empty()) continue;
    const auto middle = seen[k].begin() + static_cast<std::ptrdiff_t>(seen[k].size() / 2);
    std::nth_element(seen[k].begin(), middle, seen[k].end());
    wave[k] = *middle;
    if (seen[k].size() % 2 == 0) wave[k] = 0.5 * (wave[k] + *std::max_element(seen[k].begin(), middle));
  }
}

double correlation(std::span<const double> wave, std::span<const double> model, std::size_t shift) {
  const std::size_t n = wave.size();
  const double mean_w = std::accumulate(wave.begin(), wave.end(), 0.0) / static_cast<double>(n),
               mean_m = std::accumulate(model.begin(), model.end(), 0.0) / static_cast<double>(n);
  double ww = 0, mm = 0, wm = 0;
  for (std::size_t k = 0; k < n; ++k) {
    const double w = wave[k] - mean_w, m = model[(k + shift) % n] - mean_m;
    ww += w * w;
    mm += m * m;
    wm += w * m;
  }
  return ww > 0 && mm > 0 ? wm / std::sqrt(ww * mm) : 0;
}

/// Fit of the frames to a cycle with a given number of phases.
struct Fit {
  std::vector<double> step_wave, step_scatter, usual_repeats;  // for each phase
  std::vector<std::int64_t> ticks;
  double sigma = 0;  // scatter of the steps

  /// Negative log-likelihood for steps with scatter `of_all`, plus the cost of the number of phases
  /// (Schwarz).
  [[nodiscard]] double cost(const Steps& steps, const BedMotion& motion, double of_all) const {
    return likeliest_path(steps, step_wave, step_scatter, of_all, {motion.repeats, usual_repeats}).cost +
           0.5 * static_cast<double>(step_wave.size()) * std::log(static_cast<double>(steps.size()));
  }
};

double range_of(const std::vector<double>& wave) {
  const auto [lowest, highest] = std::minmax_element(wave.begin(), wave.end());
  return *highest - *lowest;
}

/// First frame of the two most similar consecutive cycles, where no frame is missing.
std::size_t most_similar_cycles(const Steps& steps, std::size_t n) {
  double squares = 0, least = std::numeric_limits<double>::infinity();
  std::size_t begin = 1;
  const auto square = [&](std::size_t f) { return std::pow(steps[f + n] - steps[f], 2); };
  for (std::size_t f = 1; f + n < steps.size(); ++f) {
    squares += square(f);
    if (f > n) squares -= square(f - n);
    if (f >= n && squares < least) {
      least = squares;
      begin = f + 1 - n;
    }
  }
  return begin;
}

/// Fits the phases for a period of n frames: path and wave form are refined in turn.
Fit fit_period(const Steps& steps, const BedMotion& motion, std::size_t n) {
  Fit fit{std::vector<double>(n), std::vector<double>(n), std::vector<double>(n, -1.0),
          std::vector<std::int64_t>(steps.size()), 0};
  std::iota(fit.ticks.begin(), fit.ticks.end(), 0);
  const std::size_t begin = most_similar_cycles(steps, n);
  const auto in_these = [&](std::size_t f) { return f >= begin && f < begin + 2 * n; };
  learn(steps, fit.ticks, fit.step_wave, in_these);
  if (!motion.repeats.empty()) learn(motion.repeats, fit.ticks, fit.usual_repeats, in_these);
  fit.sigma = std::max(0.1 * range_of(fit.step_wave), 1e-9);
  for (int round = 0; round < 4; ++round) {
    fit.ticks =
        likeliest_path(steps, fit.step_wave, fit.step_scatter, fit.sigma, {motion.repeats, fit.usual_repeats})
            .ticks;
    const auto is_next = [&](std::size_t f) { return f > 0 && fit.ticks[f] == fit.ticks[f - 1] + 1; };
    learn(steps, fit.ticks, fit.step_wave, is_next);
    if (!motion.repeats.empty())
      learn(motion.repeats, fit.ticks, fit.usual_repeats, [](std::size_t f) { return f > 0; });
    // Scatter: deviations are capped, so that misplaced frames do not increase the scatter and stay hidden.
    constexpr double kMaxDeviation = 0.2, kMinScatter = 0.02;  // fractions of the wave form's height
    constexpr double kFromMedian = 1.48;
    const double range = range_of(fit.step_wave);
    std::vector<double> misses(steps.size());
    double squares = 0, count = 1e-9;
    for (std::size_t f = 1; f < steps.size(); ++f) {
      if (!is_next(f)) continue;
      misses[f] = std::abs(steps[f] - fit.step_wave[static_cast<std::size_t>(fit.ticks[f]) % n]);
      squares += std::pow(std::min(misses[f], kMaxDeviation * range), 2);
      count += 1;
    }
    fit.sigma = std::max({std::sqrt(squares / count), kMinScatter * range, 1e-9});
    // A bed never lands at the same instant twice, so frames at the landing have little weight.
    learn(misses, fit.ticks, fit.step_scatter, is_next);
    for (double& scatter : fit.step_scatter) scatter *= kFromMedian;
  }
  return fit;
}

/// Heights relative to a wave form.
struct Heights {
  std::vector<double> wave, of_frames;  // both without drift
};

Heights heights_of(const Fit& fit, std::span<const double> heights) {
  Heights h;
  const double rise = std::accumulate(fit.step_wave.begin(), fit.step_wave.end(), 0.0) /
                      static_cast<double>(fit.step_wave.size());
  double height = 0;
  for (const double step : fit.step_wave) h.wave.push_back(height += step - rise);
  for (int round = 0; round < 2; ++round) {
    h.of_frames = without_drift(heights, h.wave, fit.ticks);
    learn(h.of_frames, fit.ticks, h.wave, [](std::size_t) { return true; });
  }
  return h;
}

/// Number of phases by which the start of the wave form is after phase 0.
std::size_t place_zero(std::span<const double> wave, std::optional<double> gamma, PhaseTable& table) {
  const std::size_t n = wave.size();
  if (gamma && *gamma > 0) {
    const std::vector<double> model = inelastic_bed(*gamma, static_cast<int>(n));
    std::size_t zero = 0;
    double highest = -2;
    for (std::size_t shift = 0; shift < n; ++shift)
      if (const double c = correlation(wave, model, shift); c > highest) {
        highest = c;
        zero = shift;
      }
    table.agreement = highest;
    return zero;
  }
  std::complex<double> fundamental;
  for (std::size_t k = 0; k < n; ++k)
    fundamental +=
        wave[k] * std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
  // wave ~ cos(phase + arg) = sin(phase + arg + pi/2)
  const double turn = (std::arg(fundamental) + std::numbers::pi / 2) / (2 * std::numbers::pi);
  return static_cast<std::size_t>(std::lround((turn - std::floor(turn)) * static_cast<double>(n))) % n;
}

/// Measures period and jitter. A frame taken late by delta differs from the wave form by delta times its
/// slope. For each cycle this gives the lateness; its drift is the difference between the period and N_k
/// frames. The jitter is the part of the squared differences that grows with the squared slope.
void measure_clock(const Heights& heights, std::span<const std::int64_t> ticks, PhaseTable& table) {
  const std::vector<double>&h = heights.of_frames, &wave = heights.wave;
  const std::size_t n = wave.size();
  std::vector<double> slope(h.size()), miss(h.size());
  for (std::size_t f = 0; f < h.size(); ++f) {
    const std::size_t k = static_cast<std::size_t>(ticks[f]) % n;
    slope[f] = (wave[(k + 1) % n] - wave[(k + n - 1) % n]) / 2;
    miss[f] = h[f] - wave[k];
  }
  double c0 = 0, c1 = 0, c2 = 0, l0 = 0, l1 = 0;
  for (std::size_t a = 0; a + n <= h.size(); a += n) {
    double ss = 0, sm = 0;
    for (std::size_t f = a; f < a + n; ++f) {
      ss += slope[f] * slope[f];
      sm += slope[f] * miss[f];
    }
    if (ss <= 0) continue;
    const double cycle = static_cast<double>(a) / static_cast<double>(n), late = sm / ss;
    c0 += 1;
    c1 += cycle;
    c2 += cycle * cycle;
    l0 += late;
    l1 += cycle * late;
  }
  const double drift = c0 * c2 > c1 * c1 ? (c0 * l1 - c1 * l0) / (c0 * c2 - c1 * c1) : 0;
  const auto period = static_cast<double>(n);
  table.period_frames = period * period / (period + drift);
  double s1 = 0, s2 = 0, m1 = 0, sm = 0;
  const auto count = static_cast<double>(h.size());
  for (std::size_t f = 0; f < h.size(); ++f) {
    const double ss = slope[f] * slope[f], mm = miss[f] * miss[f];
    s1 += ss;
    s2 += ss * ss;
    m1 += mm;
    sm += ss * mm;
  }
  const double spread = s2 - s1 * s1 / count;
  if (spread > 0) table.jitter = std::sqrt(std::max(0.0, (sm - s1 * m1 / count) / spread));
}

}  // namespace

std::vector<double> inelastic_bed(double gamma, int n) {
  // In units of A and omega: plate sin(t), gravity 1/gamma.
  constexpr int kSubsteps = 400, kCycles = 8;
  const double tau = 2 * std::numbers::pi / n / kSubsteps;
  double z = 0, v = 1;
  bool flies = false;
  std::vector<double> out(static_cast<std::size_t>(n));
  for (int step = 0; step < kCycles * n * kSubsteps; ++step) {
    const double t = step * tau, plate = std::sin(t);
    if (flies) {
      z += v * tau - 0.5 * tau * tau / gamma;
      v -= tau / gamma;
      if (z <= plate) flies = false;
    }
    if (!flies) {
      z = plate;
      v = std::cos(t);
      flies = gamma * std::sin(t) > 1;  // the plate falls away faster than gravity
    }
    if (step % kSubsteps == 0) out[static_cast<std::size_t>(step / kSubsteps % n)] = z;
  }
  return out;
}

double log_odds_of_repeat(std::span<const double> steps) {
  constexpr double kMaxStillStep = 4;                      // standard deviations
  constexpr double kLogOddsPerBead = 3, kMovedWeight = 9;  // a bead that moved outweighs nine that did not
  double still = 0, moved = 0;
  for (const double step : steps)
    if (std::isfinite(step)) (step < kMaxStillStep ? still : moved) += 1;
  return std::clamp(kLogOddsPerBead * (still - kMovedWeight * moved), -kMaxLogOdds, kMaxLogOdds);
}

PhaseTable estimate_phases(const BedMotion& motion, const PhaseEstimationOptions& options) {
  // Period: of the candidates the one with the smallest cost at a common scatter.
  constexpr double kMinRise = 0.02;  // bead diameters
  const Steps steps = steps_of(motion.heights);
  const auto [low, high] = std::minmax_element(motion.heights.begin(), motion.heights.end());
  const bool at_rest = low == high || *high - *low < kMinRise;
  std::optional<Fit> best;
  for (const std::size_t n : likely_periods(steps, options.frames_per_cycle, at_rest)) {
    Fit fit = fit_period(steps, motion, n);
    const double sigma = best ? std::min(fit.sigma, best->sigma) : 0;
    if (!best || fit.cost(steps, motion, sigma) < best->cost(steps, motion, sigma)) best = std::move(fit);
  }
  const auto period = static_cast<std::int64_t>(best->step_wave.size());
  const Heights heights = heights_of(*best, motion.heights);
  PhaseTable table;
  table.method = PhaseMethod::found;
  table.frames_per_cycle = static_cast<int>(period);
  measure_clock(heights, best->ticks, table);

  std::vector<std::int64_t> ticks = std::move(best->ticks);
  const std::size_t zero = place_zero(heights.wave, options.gamma, table);
  const std::int64_t first = ticks[0];
  table.first_phase = static_cast<int>((first + static_cast<std::int64_t>(zero)) % period);
  for (std::int64_t& tick : ticks) tick -= first;
  set_phases(table, ticks);
  return table;
}

}  // namespace twincell::imaging
