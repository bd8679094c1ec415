#include "imaging/phase/phases_of_times.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <optional>
#include <vector>

#include "core/constants.hpp"
#include "core/median.hpp"

namespace twincell::imaging {

namespace {

constexpr int kMostPhases = 100000;

/// Mean of exp(2 pi i P c): its length is 1 if all times are whole numbers of frames of 1/P cycles apart.
std::complex<double> mean_on_circle(std::span<const double> cycles, double per_cycle) {
  std::complex<double> sum;
  for (const double c : cycles) sum += std::polar(1.0, kTurn * c * per_cycle);
  return sum / static_cast<double>(cycles.size());
}

/// The slope of the whole frames nearest to the times.
double refined(std::span<const double> cycles, double per_cycle) {
  const double offset = std::arg(mean_on_circle(cycles, per_cycle)) / kTurn;
  const auto n = static_cast<double>(cycles.size());
  double mean_c = 0, mean_t = 0, cc = 0, ct = 0;
  const auto tick = [&](double c) { return std::round(c * per_cycle - offset); };
  for (const double c : cycles) mean_c += c / n, mean_t += tick(c) / n;
  for (const double c : cycles) {
    cc += (c - mean_c) * (c - mean_c);
    ct += (c - mean_c) * (tick(c) - mean_t);
  }
  return cc > 0 ? ct / cc : per_cycle;
}

/// The number of frames per cycle, no whole number, at which the times are nearest to whole frames: searched
/// near `whole` in the first cycles, then in twice as many each round, so that the search stays at its peak.
double frames_per_cycle_of(std::span<const double> cycles, double whole) {
  constexpr double kReach = 0.6, kFirstCycles = 2, kFineness = 8;
  double best = whole, from = whole - kReach, to = whole + kReach;
  for (double length = kFirstCycles;; length *= 2) {
    const auto end = std::upper_bound(cycles.begin(), cycles.end(), cycles.front() + length) - cycles.begin();
    const auto part = cycles.first(static_cast<std::size_t>(end));
    const double step = 1 / (kFineness * std::min(length, cycles.back() - cycles.front()));
    double most = -1;
    for (double p = from; p <= to; p += step)
      if (const double r = std::abs(mean_on_circle(part, p)); r > most) most = r, best = p;
    if (part.size() == cycles.size()) return refined(cycles, best);
    from = best - step, to = best + step;
  }
}

/// Frames per cycle of times that drift against `whole` frames per cycle by more than half a frame; absent if
/// they do not.
std::optional<double> drifting(std::span<const double> cycles, double whole) {
  // Of times that drift by half a frame, and by no jitter, the mean on the circle has this length.
  constexpr double kHalfFrame = 2 / (kTurn / 2), kBetter = 0.1;
  const double length = std::abs(mean_on_circle(cycles, whole)), span = cycles.back() - cycles.front();
  if (length >= kHalfFrame || !(span > 0)) return std::nullopt;
  const double found = frames_per_cycle_of(cycles, whole);
  const double of_found = std::abs(mean_on_circle(cycles, found));
  if (std::abs(found - whole) * span <= 0.5 || of_found < std::max(kHalfFrame, length + kBetter))
    return std::nullopt;
  return found;
}

/// Phases of frames whose period is no whole number of them. \param times as PhaseTable::cycles_at
void set_nearest_phases(PhaseTable& table, std::span<const double> cycles) {
  const double n = table.frames_per_cycle;
  std::optional<std::size_t> holder;  // of the phase before
  double held = 0;
  for (std::size_t f = 0; f < cycles.size(); ++f) {
    FramePhase& frame = table.frames[f];
    if (!std::isfinite(cycles[f])) continue;
    const double at = cycles[f] * n, nearest = std::round(at), off = std::abs(at - nearest);
    frame.cycles = cycles[f];
    frame.cycle = static_cast<std::int64_t>(std::floor(nearest / n));
    const auto phase = static_cast<std::int32_t>(nearest - static_cast<double>(frame.cycle) * n);
    if (holder && nearest == held && frame.interval > 0) {
      ++table.between;
      if (off >= std::abs(cycles[*holder] * n - held)) continue;
      table.frames[*holder].phase = -1;
    }
    frame.phase = phase;
    if (frame.interval > 0) holder = f, held = nearest;
  }
}

}  // namespace

bool set_phases_of_times(PhaseTable& table, std::span<const double> given, int stated) {
  std::vector<double> cycles(given.begin(), given.end()), known, steps;
  const double first =
      std::floor(*std::find_if(given.begin(), given.end(), [](double c) { return std::isfinite(c); }));
  for (std::size_t f = 0; f < cycles.size(); ++f) {
    cycles[f] -= first;
    if (std::isfinite(cycles[f])) known.push_back(cycles[f]);
    if (f > 0 && std::isfinite(cycles[f] - cycles[f - 1])) steps.push_back(cycles[f] - cycles[f - 1]);
  }
  const double step = steps.empty() ? 0 : upper_median(std::move(steps));
  const bool stepped = step > 0 && 1 / step <= kMostPhases;
  if (stated <= 0 && !stepped) return false;
  const int usual = stepped ? std::max(1, static_cast<int>(std::lround(1 / step))) : stated;
  table.frames_per_cycle = usual;
  if (stated > 0 && (!stepped || std::lround(stated * step) == 1)) table.frames_per_cycle = stated;
  const std::optional<double> free = drifting(known, table.frames_per_cycle);
  const double per_cycle = free.value_or(table.frames_per_cycle);
  if (free) {
    // With more phases than frames in a cycle, some phase would be without a frame in most cycles.
    constexpr double kAbove = 0.1;
    table.frames_per_cycle =
        std::clamp(static_cast<int>(std::floor(*free + kAbove)), 1, table.frames_per_cycle);
  }
  if (stated > 0 && stated != table.frames_per_cycle && std::lround(stated * per_cycle) != 0 &&
      std::abs(stated - per_cycle) >= 1)
    table.warning = fmt::format(
        "{} frames per cycle are stated, but the frames are {:.4g} per cycle; the phases are {} per cycle "
        "(camera.frames_per_cycle, --frames-per-cycle)",
        stated, per_cycle, table.frames_per_cycle);

  // Frame intervals. The delay that all frames share is their mean position between two ticks.
  table.offset = std::arg(mean_on_circle(known, per_cycle)) / kTurn;
  table.frames.assign(cycles.size(), {});
  std::vector<double> ticks;
  double squares = 0, sum = 0;
  for (std::size_t f = 0; f < cycles.size(); ++f) {
    const double tick = std::round(cycles[f] * per_cycle - table.offset);
    ticks.push_back(tick);
    if (!std::isfinite(tick)) {
      if (table.out_of_lock.empty() || table.out_of_lock.back().last + 1 < f)
        table.out_of_lock.push_back({f, f});
      table.out_of_lock.back().last = f;
      continue;
    }
    const double late = cycles[f] * per_cycle - table.offset - tick;
    squares += late * late;
    sum += late;
    if (f == 0 || !std::isfinite(ticks[f - 1])) continue;
    table.frames[f].interval = tick - ticks[f - 1];
    table.doubled += tick == ticks[f - 1] ? 1 : 0;
    table.dropped += std::max<std::int64_t>(static_cast<std::int64_t>(tick - ticks[f - 1]) - 1, 0);
  }
  // The mean on the circle is the arithmetic mean to second order only.
  const auto count = static_cast<double>(known.size());
  const double mean = sum / count, n = table.frames_per_cycle;
  table.jitter = std::sqrt(std::max(0.0, squares / count - mean * mean));
  if (free) {
    table.offset = 0;
    table.period_frames = free;
    set_nearest_phases(table, cycles);
  } else {
    table.offset += mean;
    if (const double elapsed = known.back() - known.front(); elapsed > 0)
      table.period_frames = std::round(elapsed * n) / elapsed;
    for (std::size_t f = 0; f < cycles.size(); ++f) {
      if (!std::isfinite(ticks[f])) continue;
      table.frames[f].cycle = static_cast<std::int64_t>(std::floor(ticks[f] / n));
      table.frames[f].phase =
          static_cast<std::int32_t>(ticks[f] - static_cast<double>(table.frames[f].cycle) * n);
    }
  }
  // Cycles count from that of the first phase.
  const auto begin = std::find_if(table.frames.begin(), table.frames.end(),
                                  [](const FramePhase& frame) { return frame.phase >= 0; });
  table.first_phase = begin->phase;
  const std::int64_t earliest =
      std::find_if(table.frames.begin(), table.frames.end(), [](const FramePhase& frame) {
        return frame.phase >= 0 || std::isfinite(frame.cycles);
      })->cycle;
  for (FramePhase& frame : table.frames) {
    if (frame.phase < 0 && !std::isfinite(frame.cycles)) continue;
    frame.cycle -= earliest;
    frame.cycles -= static_cast<double>(earliest);
  }
  return true;
}

}  // namespace twincell::imaging
