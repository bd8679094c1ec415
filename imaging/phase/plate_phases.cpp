#include "imaging/phase/plate_phases.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/constants.hpp"
#include "core/plural.hpp"
#include "imaging/phase/phases_of_times.hpp"

namespace twincell::imaging {

namespace {

bool moves(double amplitude, double scatter) {
  constexpr double kMinAmplitude_px = 1, kMaxScatter = 0.15;  // scatter as a fraction of the amplitude
  return amplitude >= kMinAmplitude_px && scatter <= kMaxScatter * amplitude;
}

/// Cost of a sine, natural log-odds: each missing or doubled frame costs what twelve nats of deviation do.
double cost(std::size_t frames, double scatter, double amplitude, std::int64_t slips) {
  constexpr double kCostPerSlip = 12, kMinScatter = 0.02;  // scatter as a fraction of the amplitude
  return static_cast<double>(frames) * std::log(std::max(scatter / amplitude, kMinScatter)) +
         kCostPerSlip * static_cast<double>(slips);
}

/// Whether the period of the plate clearly differs from N frames, and the phases of N would misplace the
/// plate. A bed at rest on a plate that moves by more than a bead seems to bounce if its phases are off by a
/// tenth of a frame.
bool drifts(const SineSlips& whole, const FreeSine& free, int frames_per_cycle) {
  constexpr double kClearly = 7;         // standard errors; frames have jitter
  constexpr double kMinMisplaced = 0.1;  // px, at either end of the film
  const auto seen = static_cast<double>(whole.seen), frames = static_cast<double>(whole.ticks.size());
  const double radians = kTurn * std::abs(1 - frames_per_cycle / free.period) * frames / frames_per_cycle;
  // Of the frequency of a sine in independent noise, times the length of the film.
  const double error = std::sqrt(24 / seen) * free.scatter / free.amplitude;
  return radians > kClearly * error && 0.5 * radians * free.amplitude > kMinMisplaced &&
         free.scatter < whole.scatter;
}

std::int64_t number_of_slips(const SineSlips& fit) {
  std::int64_t slips = 0;
  for (std::size_t f = 1; f < fit.ticks.size(); ++f) slips += fit.ticks[f] == fit.ticks[f - 1] + 1 ? 0 : 1;
  return slips;
}

double cost(const SineSlips& fit) {
  return cost(fit.ticks.size(), fit.scatter, fit.amplitude, number_of_slips(fit));
}
double cost(const FreeSine& fit, std::span<const double> plate) {
  return cost(plate.size(), fit.scatter, fit.amplitude, 0);
}

/// How the motion of a plate that follows no single sine differs between begin and end, each of which does
/// follow one; empty if it does not.
std::string change_of(std::span<const double> plate, int frames_per_cycle) {
  constexpr std::size_t kComparedCycles = 3;       // at either end
  constexpr double kMaxAmplitudeDifference = 0.1;  // relative
  const std::size_t part =
      std::min(plate.size() / 2, kComparedCycles * static_cast<std::size_t>(frames_per_cycle));
  if (part < static_cast<std::size_t>(frames_per_cycle)) return {};
  const auto begin = fit_sine_with_slips(plate.first(part), frames_per_cycle),
             end = fit_sine_with_slips(plate.last(part), frames_per_cycle);
  const auto is_clear = [](const auto& fit) {
    return fit && moves(fit->amplitude, fit->scatter) && fit->dropped + fit->doubled == 0;
  };
  if (!is_clear(begin) || !is_clear(end)) return {};
  if (std::abs(begin->amplitude - end->amplitude) <=
      kMaxAmplitudeDifference * std::max(begin->amplitude, end->amplitude))
    return {};
  return fmt::format("moves by {:.3g} px in the first {} frames and by {:.3g} px in the last {}",
                     begin->amplitude, part, end->amplitude, part);
}

/// Distance of the plate from its sine over the largest that its errors allow. \param sine height by frame
template <class SineOfFrame>
std::vector<double> misses_of(std::span<const double> plate, double amplitude, double scatter,
                              const SineOfFrame& sine) {
  // Allowed distance: the largest of a multiple of the scatter, a fraction of the amplitude, and 1 px.
  constexpr double kAllowedScatter = 5, kAllowedShare = 0.1, kAllowed_px = 1;
  const double most = std::max({kAllowedScatter * scatter, kAllowedShare * amplitude, kAllowed_px});
  std::vector<double> misses;
  for (std::size_t f = 0; f < plate.size(); ++f) misses.push_back(std::abs(plate[f] - sine(f)) / most);
  return misses;
}

/// read_plate() with the sine of any period. \param free_sine gives it; its argument: N explains all frames,
/// so that the period is near
template <class FreeSineSource>
PlateReading read(std::span<const double> plate, int frames_per_cycle, const FreeSineSource& free_sine) {
  constexpr double kMinSeenShare = 0.6;  // of the frames
  constexpr double kMaxDrift = 0.5;      // between the stated and the free sine over the film, frames
  PlateReading out;
  const auto seen = std::count_if(plate.begin(), plate.end(), [](double z) { return std::isfinite(z); });
  if (static_cast<double>(seen) < kMinSeenShare * static_cast<double>(plate.size()) || seen == 0) {
    out.why_not = "the plate is not in the picture";
    return out;
  }
  if (frames_per_cycle < 3) {
    out.why_not = "a cycle has fewer than three frames";
    return out;
  }
  if (plate.size() < static_cast<std::size_t>(frames_per_cycle)) {
    out.why_not = fmt::format("{} are less than a cycle", plural(plate.size(), "frame"));
    return out;
  }
  std::optional<SineSlips> fit = fit_sine_with_slips(plate, frames_per_cycle);
  const bool fits = fit && moves(fit->amplitude, fit->scatter);
  const bool intact = fits && fit->dropped + fit->doubled == 0;
  if (const std::optional<FreeSine> free = free_sine(intact); free && moves(free->amplitude, free->scatter)) {
    const double drift = std::abs(frames_per_cycle / free->period - 1) * static_cast<double>(plate.size());
    if (intact ? drifts(*fit, *free, frames_per_cycle)
               : drift > kMaxDrift && (!fits || cost(*free, plate) < cost(*fit)))
      out.other = free;
  }
  if (fits) {
    const std::vector<double> misses = misses_of(plate, fit->amplitude, fit->scatter,
                                                 [&](std::size_t f) { return fit->at(f, frames_per_cycle); });
    out.out_of_lock = stretches_out_of_lock(misses, frames_per_cycle);
    out.misread = static_cast<std::size_t>(
        std::count_if(misses.begin(), misses.end(), [](double miss) { return miss > 1; }));
    constexpr double kFarMiss = 3;  // in units of the allowed distance
    out.far_off = static_cast<std::size_t>(
        std::count_if(misses.begin(), misses.end(), [](double miss) { return miss > kFarMiss; }));
    for (const FrameStretch& s : out.out_of_lock)
      for (std::size_t f = s.first; f <= s.last; ++f) {
        out.misread -= misses[f] > 1 ? 1 : 0;
        out.far_off -= misses[f] > kFarMiss ? 1 : 0;
      }
    out.slips = std::move(fit);
  } else if (const std::string changes = change_of(plate, frames_per_cycle); !changes.empty())
    out.changes = changes;
  else
    out.why_not = "no edge at the bottom of the picture moves as a plate";
  return out;
}

/// Phases of a plate whose period is not a whole number of frames; nothing if it does not move as a sine.
std::optional<PhaseTable> phases_of_uneven(std::span<const double> plate, const std::optional<FreeSine>& sine,
                                           int stated) {
  constexpr double kMinFramesPerCycle = 3;
  if (!sine || !moves(sine->amplitude, sine->scatter) || sine->period < kMinFramesPerCycle)
    return std::nullopt;
  std::vector<double> cycles;
  for (std::size_t f = 0; f < plate.size(); ++f)
    cycles.push_back(static_cast<double>(f) / sine->period + sine->phase);
  const std::vector<FrameStretch> out_of_lock = stretches_out_of_lock(
      misses_of(plate, sine->amplitude, sine->scatter, [&](std::size_t f) { return sine->at(f); }),
      sine->period);
  for (const FrameStretch& s : out_of_lock)
    for (std::size_t f = s.first; f <= s.last; ++f) cycles[f] = kNaN;
  PhaseTable table{.method = PhaseMethod::found};
  if (frames_in(out_of_lock) == plate.size() || !set_phases_of_times(table, cycles, stated, sine->period))
    return std::nullopt;
  table.jitter.reset();  // that of the sine's own times
  table.checked_by = "the plate";
  if (!table.out_of_lock.empty())
    table.warning += (table.warning.empty() ? "" : "; ") + out_of_lock_in_words(table);
  return table;
}

}  // namespace

PlateReading read_plate(std::span<const double> plate, int frames_per_cycle) {
  return read(plate, frames_per_cycle, [&](bool intact) {
    return intact ? fit_free_sine(plate, frames_per_cycle) : fit_free_sine(plate);
  });
}

std::optional<PhaseTable> phases_from_plate(std::span<const double> plate, int stated, double offset) {
  const std::optional<FreeSine> free = stated == 0 ? fit_free_sine(plate) : std::nullopt;
  if (stated == 0 && !free) return std::nullopt;
  std::optional<PlateReading> best;
  std::optional<FreeSine> uneven = free;
  int best_n = 0;
  for (const int n : frames_per_cycle_to_try(stated, free ? free->period : 0)) {
    PlateReading reading = free ? read(plate, n, [&](bool /*intact*/) { return free; })
                                : read_plate(plate, n);  // one search for all n
    if (stated != 0 && reading.other && std::abs(reading.other->period - stated) < 1) uneven = reading.other;
    if (!reading.fits() || (best && cost(*reading.slips) >= cost(*best->slips))) continue;
    best = std::move(reading);
    best_n = n;
  }
  if (!best) return phases_of_uneven(plate, uneven, stated);
  PhaseTable table{.method = PhaseMethod::found, .frames_per_cycle = best_n};
  table.offset = offset;
  table.first_phase = static_cast<int>((std::lround(best->slips->phase * best_n - offset) + best_n) % best_n);
  table.checked_by = "the plate";
  set_phases(table, best->slips->ticks);
  if (!best->out_of_lock.empty()) {
    leave_out(table, best->out_of_lock);
    table.warning = out_of_lock_in_words(table);
  }
  return table;
}

}  // namespace twincell::imaging
