#include "imaging/phase/phase_lock.hpp"

namespace twincell {

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

}  // namespace twincell
