#include "imaging/phase/phase_lock.hpp"

#include <algorithm>

namespace twincell::imaging {

FramePhase PhaseTable::at(std::int64_t frame) const {
  if (!frames.empty() && frame < static_cast<std::int64_t>(frames.size()))
    return frames[static_cast<std::size_t>(frame)];
  const PhaseLock lock{frames_per_cycle, first_phase};
  return {lock.phase(frame), lock.cycle(frame), 1};
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

}  // namespace twincell::imaging
