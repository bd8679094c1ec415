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

constexpr int kMaxPhases = 100000;

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

/// The number of frames per cycle, in general not whole, at which the times are nearest to whole frames:
/// searched near `whole` in the first cycles, then in twice as many each round, so that the search stays at
/// its peak.
double frames_per_cycle_of(std::span<const double> cycles, double whole) {
  constexpr double kReach = 0.6;      // frames per cycle
  constexpr double kFirstCycles = 2;  // length of the first part, cycles
  constexpr double kFineness = 8;     // steps within the width of the peak
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
  constexpr double kHalfFrame = 2 / (kTurn / 2), kMinImprovement = 0.1;
  const double length = std::abs(mean_on_circle(cycles, whole)), span = cycles.back() - cycles.front();
  if (length >= kHalfFrame || !(span > 0)) return std::nullopt;
  const double found = frames_per_cycle_of(cycles, whole);
  const double of_found = std::abs(mean_on_circle(cycles, found));
  if (std::abs(found - whole) * span <= 0.5 || of_found < std::max(kHalfFrame, length + kMinImprovement))
    return std::nullopt;
  return found;
}

/// Phases of frames whose period is not a whole number of frames. \param times as PhaseTable::cycles_at
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

/// The times, counted from the whole cycle in which the first one lies.
struct CountedTimes {
  std::vector<double> cycles;  // of each frame; not finite: unknown
  std::vector<double> known;
  double step = 0;  // median from one frame to the next, cycles; 0: no two neighbours are known
};

CountedTimes counted_times(std::span<const double> given) {
  CountedTimes times{.cycles = {given.begin(), given.end()}, .known = {}};
  std::vector<double>& cycles = times.cycles;
  std::vector<double> steps;
  const double first =
      std::floor(*std::find_if(given.begin(), given.end(), [](double c) { return std::isfinite(c); }));
  for (std::size_t f = 0; f < cycles.size(); ++f) {
    cycles[f] -= first;
    if (std::isfinite(cycles[f])) times.known.push_back(cycles[f]);
    if (f > 0 && std::isfinite(cycles[f] - cycles[f - 1])) steps.push_back(cycles[f] - cycles[f - 1]);
  }
  if (!steps.empty()) times.step = upper_median(std::move(steps));
  return times;
}

/// The whole number of frames per cycle: the stated one, unless the median step is not one of its frames.
/// \returns absent if neither the times nor the user give one
std::optional<int> whole_frames_per_cycle(double step, int stated) {
  const bool stepped = step > 0 && 1 / step <= kMaxPhases;
  if (stated <= 0 && !stepped) return std::nullopt;
  if (stated > 0 && (!stepped || std::lround(stated * step) == 1)) return stated;
  return stepped ? std::max(1, static_cast<int>(std::lround(1 / step))) : stated;
}

/// Number of phases of a period of `per_cycle` frames. With more phases than frames in a cycle, some phase
/// would be without a frame in most cycles.
int phases_of_uneven_period(double per_cycle, int at_most) {
  constexpr double kTolerance = 0.1;  // frames per cycle
  return std::clamp(static_cast<int>(std::floor(per_cycle + kTolerance)), 1, at_most);
}

/// The warning that another number of frames per cycle is stated; empty: none.
std::string other_period_in_words(int stated, double per_cycle, int phases) {
  if (stated <= 0 || stated == phases || std::lround(stated * per_cycle) == 0 ||
      std::abs(stated - per_cycle) < 1)
    return {};
  return fmt::format(
      "{} frames per cycle are stated, but the frames are {:.4g} per cycle; the phases are {} per cycle "
      "(camera.frames_per_cycle, --frames-per-cycle)",
      stated, per_cycle, phases);
}

/// The frames' whole numbers of frame intervals, and how much later than these the frames are.
struct WholeTicks {
  std::vector<double> ticks;    // of each frame; not finite: unknown
  double sum = 0, squares = 0;  // of the delays after table.offset, frames
};

/// Rounds the times to whole frames, and sets intervals, dropped and doubled frames and those without a time.
/// The delay that all frames share, table.offset, is their mean position between two ticks.
WholeTicks set_intervals(PhaseTable& table, std::span<const double> cycles, double per_cycle) {
  WholeTicks out;
  std::vector<double>& ticks = out.ticks;
  table.frames.assign(cycles.size(), {});
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
    out.squares += late * late;
    out.sum += late;
    if (f == 0 || !std::isfinite(ticks[f - 1])) continue;
    table.frames[f].interval = tick - ticks[f - 1];
    table.doubled += tick == ticks[f - 1] ? 1 : 0;
    table.dropped += std::max<std::int64_t>(static_cast<std::int64_t>(tick - ticks[f - 1]) - 1, 0);
  }
  return out;
}

/// Phases of frames whose period is a whole number of frames.
void set_whole_phases(PhaseTable& table, const std::vector<double>& ticks) {
  const double n = table.frames_per_cycle;
  for (std::size_t f = 0; f < ticks.size(); ++f) {
    if (!std::isfinite(ticks[f])) continue;
    table.frames[f].cycle = static_cast<std::int64_t>(std::floor(ticks[f] / n));
    table.frames[f].phase =
        static_cast<std::int32_t>(ticks[f] - static_cast<double>(table.frames[f].cycle) * n);
  }
}

/// Sets the first phase, and counts the cycles from the first frame with a time.
void count_from_first(PhaseTable& table) {
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
}

}  // namespace

bool set_phases_of_times(PhaseTable& table, std::span<const double> given, int stated,
                         std::optional<double> period) {
  const CountedTimes times = counted_times(given);
  const std::optional<int> whole = whole_frames_per_cycle(times.step, stated);
  if (!whole) return false;
  const std::optional<double> free = period ? period : drifting(times.known, *whole);
  const double per_cycle = free.value_or(*whole);
  table.frames_per_cycle = free ? phases_of_uneven_period(*free, *whole) : *whole;
  if (std::string warning = other_period_in_words(stated, per_cycle, table.frames_per_cycle);
      !warning.empty())
    table.warning = std::move(warning);

  table.offset = std::arg(mean_on_circle(times.known, per_cycle)) / kTurn;
  const WholeTicks whole_ticks = set_intervals(table, times.cycles, per_cycle);
  // The mean on the circle is the arithmetic mean to second order only.
  const auto count = static_cast<double>(times.known.size());
  const double mean = whole_ticks.sum / count;
  table.jitter = std::sqrt(std::max(0.0, whole_ticks.squares / count - mean * mean));
  if (free) {
    table.offset = 0;
    table.period_frames = free;
    set_nearest_phases(table, times.cycles);
  } else {
    table.offset += mean;
    const double n = table.frames_per_cycle;
    if (const double elapsed = times.known.back() - times.known.front(); elapsed > 0)
      table.period_frames = std::round(elapsed * n) / elapsed;
    set_whole_phases(table, whole_ticks.ticks);
  }
  count_from_first(table);
  return true;
}

}  // namespace twincell::imaging
