#pragma once
/// \file
/// Frame number to drive phase, for a camera triggered at a whole number of frames per cycle.

#include <cstdint>

#include "analysis/trajectory/error.hpp"

namespace twincell {

/// Frame f shows phase k = (f + k_0) mod N_k of cycle j = (f + k_0) div N_k, i.e. the fraction k/N_k of a
/// period; phase 0 is the plate at its mean height moving up (drive.hpp). No frame may be missing from the
/// stack.
struct PhaseLock {
  int frames_per_cycle = 0;  ///< N_k; 0: not phase-locked
  int first_phase = 0;       ///< k_0, the phase of frame 0, in 0 .. N_k - 1

  [[nodiscard]] bool locked() const { return frames_per_cycle > 0; }
  [[nodiscard]] std::int32_t phase(std::int64_t frame) const {
    return locked() ? static_cast<std::int32_t>((frame + first_phase) % frames_per_cycle) : -1;
  }
  [[nodiscard]] std::int64_t cycle(std::int64_t frame) const {
    return locked() ? (frame + first_phase) / frames_per_cycle : -1;
  }
  /// Fraction of a period at which the frame was taken. Only when locked.
  [[nodiscard]] double fraction(std::int64_t frame) const {
    return static_cast<double>(phase(frame)) / static_cast<double>(frames_per_cycle);
  }
  /// \throws ConfigError unless N_k >= 0 and 0 <= k_0 < N_k
  void check(const Where& where) const {
    if (frames_per_cycle < 0) throw ConfigError(where, "frames per cycle must not be negative.");
    if (locked() && (first_phase < 0 || first_phase >= frames_per_cycle))
      throw ConfigError(where, "the first phase must lie in 0 .. frames per cycle - 1.");
  }
};

}  // namespace twincell
