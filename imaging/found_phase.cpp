#include "imaging/found_phase.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <numeric>

#include "analysis/trajectory/median.hpp"

namespace twincell {

namespace {

constexpr std::size_t kMostLags = 2000;
constexpr std::size_t kMostFrames = 20000;  // for the period; its phases are found for all
constexpr double kDip = 0.2;                // of the normalised difference, below which a lag is a period
constexpr double kDipGiven = 0.8;           // the same where the period was given
constexpr double kPrice = 12;               // of a dropped or doubled frame, natural logarithm of odds
constexpr int kMostDropped = 3;             // in a row

/// Mean over `width` frames about each, the ends by what is there.
std::vector<double> without_drift(std::span<const double> h, std::size_t width) {
  std::vector<double> sums(h.size() + 1);
  std::partial_sum(h.begin(), h.end(), sums.begin() + 1);
  std::vector<double> out(h.size());
  for (std::size_t f = 0; f < h.size(); ++f) {
    // At the ends the same whole period is used, not half of it.
    std::size_t a = f >= width / 2 ? f - width / 2 : 0;
    const std::size_t b = std::min(a + width, h.size());
    a = b >= width ? b - width : 0;
    out[f] = h[f] - (sums[b] - sums[a]) / static_cast<double>(b - a);
  }
  return out;
}

/// Mean squared difference at each lag over its mean at all smaller lags.
std::vector<double> normalised_difference(std::span<const double> v, std::size_t lags) {
  std::vector<double> out(lags + 1, 1);
  double sum = 0;
  for (std::size_t lag = 1; lag <= lags; ++lag) {
    double squares = 0;
    for (std::size_t f = lag; f < v.size(); ++f) squares += (v[f] - v[f - lag]) * (v[f] - v[f - lag]);
    squares /= static_cast<double>(v.size() - lag);
    sum += squares;
    out[lag] = sum > 0 ? squares * static_cast<double>(lag) / sum : 1;
  }
  return out;
}

int find_period(std::span<const double> h, int given) {
  auto refuse = [](const std::string& why) {
    throw InputError(Where{.file = {}, .key = "phase-lock"},
                     why + "; give --phase-lock N or a list of triggers instead.");
  };
  const std::size_t n = std::min(h.size(), kMostFrames);
  if (n < 9 || (given > 0 && n < 3 * static_cast<std::size_t>(given)))
    refuse(fmt::format("{} frames are too few to find three cycles in", h.size()));
  // Differences of neighbouring frames know no drift.
  std::vector<double> v(n - 1);
  for (std::size_t f = 1; f < n; ++f) v[f - 1] = h[f] - h[f - 1];
  const std::size_t lags = std::min(kMostLags, v.size() / 2);
  const std::vector<double> dip = normalised_difference(v, lags);
  std::size_t best = 0;
  if (given > 0) {
    best = static_cast<std::size_t>(given);
    if (best >= lags || dip[best] > kDipGiven)
      refuse(fmt::format("the bed's motion does not repeat itself after {} frames", given));
  } else {
    for (std::size_t lag = 2; lag < lags && best == 0; ++lag)
      if (dip[lag] < kDip && dip[lag] <= dip[lag + 1] && dip[lag] <= dip[lag - 1]) best = lag;
    if (best == 0) refuse("the bed's motion does not repeat itself");
  }
  return static_cast<int>(best);
}

/// Ticks (phases counted on through all cycles) of the likeliest path.
std::vector<std::int64_t> likeliest_path(std::span<const double> h, std::span<const double> wave,
                                         double sigma) {
  const std::size_t n = wave.size();
  const double weight = 0.5 / (sigma * sigma);
  std::vector<double> cost(n), next(n);
  std::vector<std::uint8_t> step(h.size() * n, 1);
  for (std::size_t k = 0; k < n; ++k) cost[k] = weight * (h[0] - wave[k]) * (h[0] - wave[k]);
  for (std::size_t f = 1; f < h.size(); ++f) {
    for (std::size_t k = 0; k < n; ++k) {
      double least = std::numeric_limits<double>::infinity();
      for (std::size_t s = 0; s <= 1 + kMostDropped; ++s) {
        const double price = s == 1 ? 0 : kPrice + (s > 2 ? 2.0 * static_cast<double>(s - 2) : 0);
        const double c = cost[(k + n * (1 + kMostDropped) - s) % n] + price;
        if (c >= least) continue;
        least = c;
        step[f * n + k] = static_cast<std::uint8_t>(s);
      }
      // One wild frame must not buy a slip.
      next[k] = least + std::min(weight * (h[f] - wave[k]) * (h[f] - wave[k]), 0.8 * kPrice);
    }
    std::swap(cost, next);
  }
  auto k = static_cast<std::size_t>(std::min_element(cost.begin(), cost.end()) - cost.begin());
  std::vector<std::int64_t> ticks(h.size());
  std::vector<std::uint8_t> steps(h.size(), 0);
  for (std::size_t f = h.size() - 1; f > 0; --f) {
    steps[f] = step[f * n + k];
    k = (k + n * (1 + kMostDropped) - steps[f]) % n;
  }
  ticks[0] = static_cast<std::int64_t>(k);
  for (std::size_t f = 1; f < h.size(); ++f) ticks[f] = ticks[f - 1] + steps[f];
  return ticks;
}

/// Heights with frames that are missing filled in on a straight line and doubled ones taken out.
std::vector<double> mended(std::span<const double> h, std::span<const std::int64_t> ticks) {
  std::vector<double> out = {h[0]};
  for (std::size_t f = 1; f < h.size(); ++f) {
    const std::int64_t passed = ticks[f] - ticks[f - 1];
    for (std::int64_t i = 1; i <= passed; ++i)
      out.push_back(h[f - 1] + (h[f] - h[f - 1]) * static_cast<double>(i) / static_cast<double>(passed));
  }
  return out;
}

/// Median of the heights at each phase, so that a damaged cycle among three does no harm; a phase that was
/// never seen keeps what it had.
void learn_wave(std::span<const double> h, std::span<const std::int64_t> ticks, std::vector<double>& wave) {
  std::vector<std::vector<double>> seen(wave.size());
  for (std::size_t f = 0; f < h.size(); ++f)
    seen[static_cast<std::size_t>(ticks[f]) % wave.size()].push_back(h[f]);
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

PhaseTable find_phases(std::span<const double> heights, const FoundPhaseOptions& options) {
  const int period = find_period(heights, options.frames_per_cycle);
  const auto n = static_cast<std::size_t>(period);
  if (n < 3)
    throw InputError(
        Where{.file = {}, .key = "phase-lock"},
        "fewer than three frames show a cycle; give --phase-lock N or a list of triggers instead.");
  PhaseTable table;
  table.way = "found";
  table.frames_per_cycle = period;

  // The first wave form is that of the few cycles that are most alike: no frame is missing there.
  std::vector<double> h = without_drift(heights, n);
  std::vector<double> wave(n);
  {
    const std::size_t window = std::min(h.size(), 4 * n);
    double least = std::numeric_limits<double>::infinity();
    std::size_t begin = 0;
    for (std::size_t a = 0; a + window <= h.size(); a += n) {
      double squares = 0;
      for (std::size_t f = a + n; f < a + window; ++f) squares += (h[f] - h[f - n]) * (h[f] - h[f - n]);
      if (squares < least) {
        least = squares;
        begin = a;
      }
    }
    std::vector<std::int64_t> even(window);
    std::iota(even.begin(), even.end(), static_cast<std::int64_t>(begin));
    learn_wave(std::span(h).subspan(begin, window), even, wave);
  }
  auto [low, high] = std::minmax_element(wave.begin(), wave.end());
  double sigma = 0.1 * (*high - *low);
  std::vector<std::int64_t> ticks;
  for (int round = 0; round < 4; ++round) {
    ticks = likeliest_path(h, wave, std::max(sigma, 1e-9));
    // The drift is the mean over a cycle: over one in which no frame is missing.
    const std::vector<double> whole = without_drift(mended(heights, ticks), n);
    std::vector<double> misses;
    for (std::size_t f = 0; f < h.size(); ++f) h[f] = whole[static_cast<std::size_t>(ticks[f] - ticks[0])];
    learn_wave(h, ticks, wave);
    for (std::size_t f = 0; f < h.size(); ++f)
      misses.push_back(std::abs(h[f] - wave[static_cast<std::size_t>(ticks[f]) % n]));
    const auto [lowest, highest] = std::minmax_element(wave.begin(), wave.end());
    sigma = std::max(1.48 * upper_median(std::move(misses)), 0.02 * (*highest - *lowest));
  }

  // Where phase 0 lies.
  std::size_t zero = 0;
  if (options.gamma && *options.gamma > 0) {
    const std::vector<double> model = inelastic_bed(*options.gamma, period);
    double best = -2;
    for (std::size_t shift = 0; shift < n; ++shift)
      if (const double c = correlation(wave, model, shift); c > best) {
        best = c;
        zero = shift;
      }
    table.agreement = best;
  } else {
    std::complex<double> fundamental;
    for (std::size_t k = 0; k < n; ++k)
      fundamental +=
          wave[k] * std::polar(1.0, -2 * std::numbers::pi * static_cast<double>(k) / static_cast<double>(n));
    // wave ~ cos(phase + arg) = sin(phase + arg + pi/2)
    const double turn = (std::arg(fundamental) + std::numbers::pi / 2) / (2 * std::numbers::pi);
    zero = static_cast<std::size_t>(std::lround((turn - std::floor(turn)) * static_cast<double>(n))) % n;
  }
  for (std::int64_t& tick : ticks) tick += static_cast<std::int64_t>(zero);
  const std::int64_t whole = ticks[0] / period * period;
  for (std::size_t f = 0; f < ticks.size(); ++f) {
    const std::int64_t tick = ticks[f] - whole, passed = f == 0 ? 1 : ticks[f] - ticks[f - 1];
    table.frames.push_back(
        {static_cast<std::int32_t>(tick % period), tick / period, static_cast<double>(passed)});
    if (passed == 0) ++table.doubled;
    if (passed > 1) table.dropped += passed - 1;
  }
  table.first_phase = table.frames.front().phase;

  // A frame taken late by delta misses the wave form by delta times its slope. Cycle by cycle that gives the
  // lateness, whose drift is the difference between the period and N_k frames. Without it, the part of the
  // squared misses that grows with the squared slope is jitter.
  std::vector<double> slope(h.size()), miss(h.size());
  for (std::size_t f = 0; f < h.size(); ++f) {
    const auto k = static_cast<std::size_t>(ticks[f] - static_cast<std::int64_t>(zero)) % n;
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
  return table;
}

}  // namespace twincell
