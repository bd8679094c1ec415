#include "imaging/phase/phase_lock.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace twincell::imaging {

FramePhase PhaseTable::at(std::int64_t frame) const {
  if (!frames.empty() && frame < static_cast<std::int64_t>(frames.size()))
    return frames[static_cast<std::size_t>(frame)];
  const PhaseLock lock{frames_per_cycle, first_phase};
  return {lock.phase(frame), lock.cycle(frame), 1};
}

std::optional<double> PhaseTable::cycles_at(std::int64_t frame) const {
  const FramePhase now = at(frame);
  if (std::isfinite(now.cycles)) return now.cycles;
  if (!locked() || now.phase < 0) return std::nullopt;
  return static_cast<double>(now.cycle) + (now.phase + offset) / frames_per_cycle;
}

bool PhaseTable::is_used(std::int64_t frame) const {
  if (frame > 0 && at(frame).interval == 0) return false;
  return !locked() || cycles_at(frame).has_value();
}

PhaseTable fixed_phases(const PhaseLock& lock) {
  PhaseTable table;
  table.method = lock.locked() ? PhaseMethod::fixed : PhaseMethod::none;
  table.frames_per_cycle = lock.frames_per_cycle;
  table.first_phase = lock.first_phase;
  table.offset = lock.offset;
  return table;
}

void set_phases(PhaseTable& table, std::span<const std::int64_t> ticks) {
  const std::int64_t n = table.frames_per_cycle;
  table.frames.clear();
  table.dropped = table.doubled = 0;
  for (std::size_t f = 0; f < ticks.size(); ++f) {
    const std::int64_t at = ticks[f] + table.first_phase, by = f == 0 ? 1 : ticks[f] - ticks[f - 1];
    table.frames.push_back({static_cast<std::int32_t>(at % n), at / n, static_cast<double>(by)});
    table.doubled += by == 0 ? 1 : 0;
    table.dropped += std::max<std::int64_t>(by - 1, 0);
  }
}

void leave_out(PhaseTable& table, std::span<const FrameStretch> stretches) {
  for (const FrameStretch& s : stretches) {
    for (std::size_t f = s.first; f <= s.last; ++f) table.frames[f] = {};
    // The drive may go on with any phase.
    if (s.last + 1 < table.frames.size()) table.frames[s.last + 1].interval = 1;
    table.out_of_lock.push_back(s);
  }
  table.dropped = table.doubled = 0;
  for (std::size_t f = 1; f < table.frames.size(); ++f) {
    const auto by = static_cast<std::int64_t>(table.frames[f].interval);
    table.doubled += by == 0 ? 1 : 0;
    table.dropped += std::max<std::int64_t>(by - 1, 0);
  }
}

std::string out_of_lock_in_words(const PhaseTable& table) {
  return fmt::format(
      "the plate does not follow the drive in {} of {} frames ({}); they have no phase and are left out of "
      "the trajectory",
      frames_in(table.out_of_lock), table.frames.size(), in_words(table.out_of_lock));
}

}  // namespace twincell::imaging
