#pragma once
/// \file
/// Phase lock: which phase of the drive a frame shows.
///
/// Three methods determine it: a whole number of frames per cycle (here), a list of triggers
/// (trigger_list.hpp), and the motion of the plate (plate_phases.hpp) or of the bed (phase_estimation.hpp).
/// All return a PhaseTable.

#include <array>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "core/choice.hpp"
#include "core/error.hpp"
#include "imaging/phase/out_of_lock.hpp"

namespace twincell::imaging {

/// Frame f shows phase k = (f + k_0) mod N_k of cycle j = (f + k_0) div N_k, i.e. the fraction k/N_k of a
/// period. Phase 0 is the plate at its mean height moving up (drive.hpp). No frame may be missing from the
/// stack.
struct PhaseLock {
  int frames_per_cycle = 0;  ///< N_k; 0: not phase-locked
  int first_phase = 0;       ///< k_0, the phase of frame 0, in 0 .. N_k - 1
  double offset = 0;         ///< frame intervals by which every frame was taken later than its phase

  [[nodiscard]] bool locked() const { return frames_per_cycle > 0; }
  /// k of a frame, in 0 .. N_k - 1; -1 if not locked.
  /// \param frame f >= 0
  [[nodiscard]] std::int32_t phase(std::int64_t frame) const {
    return locked() ? static_cast<std::int32_t>((frame + first_phase) % frames_per_cycle) : -1;
  }
  /// j of a frame; -1 if not locked.
  [[nodiscard]] std::int64_t cycle(std::int64_t frame) const {
    return locked() ? (frame + first_phase) / frames_per_cycle : -1;
  }
  /// Fraction of a period at which the frame was taken. Valid only if locked.
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

/// Phase and cycle at which one frame was taken.
struct FramePhase {
  std::int32_t phase = -1;  ///< k in 0 .. N_k - 1; -1: not locked, or between two phases
  std::int64_t cycle = -1;  ///< j; -1: not locked
  double interval = 1;      ///< frame intervals since the previous frame: 0 if it shows the same instant
                            ///< again, 1 + n if n frames were dropped in between
  /// Cycles of the drive since phase 0 of cycle 0; NaN: j + (k + PhaseTable::offset)/N_k
  double cycles = std::numeric_limits<double>::quiet_NaN();
};

/// Source of the phases of a stack.
enum class PhaseMethod { none, fixed, found, triggers };
/// A source of phases: its word in results, and what selects it on the command line.
struct PhaseMethodRow {
  PhaseMethod value;
  std::string_view word;
  std::string_view option;  ///< value of --phase-lock
  std::string_view help;
};
/// All sources of phases.
inline constexpr std::array kPhaseMethods = {
    PhaseMethodRow{PhaseMethod::none, "none", "none", "no phases"},
    PhaseMethodRow{PhaseMethod::fixed, "fixed", "N", "N frames per cycle, every frame taken"},
    PhaseMethodRow{PhaseMethod::found, "found", "found",
                   "phases from the motion of the plate, or of the bed where no plate is seen"},
    PhaseMethodRow{PhaseMethod::triggers, "triggers", "LIST.csv", "a list of trigger times or phases"}};

/// The phases of a stack, with their quality measures and defects.
struct PhaseTable {
  PhaseMethod method = PhaseMethod::none;
  int frames_per_cycle = 0;             ///< N_k; 0: not locked
  int first_phase = 0;                  ///< of frame 0, or of the first frame that is not out of lock
  std::optional<double> period_frames;  ///< the period as measured, frames
  std::optional<double> jitter;     ///< rms distance of the frames from their phases, frame intervals; for an
                                    ///< estimated phase an upper bound, since the bed varies too
  std::optional<double> agreement;  ///< for an estimated phase: correlation of the motion with that of a
                                    ///< model bed on this drive, which places phase 0; absent: phase 0 is
                                    ///< where the bed's fundamental passes its mean upwards
  std::int64_t dropped = 0;         ///< frames that are missing
  std::int64_t doubled = 0;         ///< frames that repeat the previous instant
  std::vector<FramePhase> frames;   ///< empty: frame f follows PhaseLock{frames_per_cycle, first_phase}
  double offset = 0;                ///< frame intervals by which every frame was taken later than its phase
  /// Frames without a phase, in which the plate does not follow the drive
  std::vector<FrameStretch> out_of_lock;
  std::int64_t between = 0;  ///< frames between two phases, of a period that is not a whole number of frames
  std::string checked_by;    ///< "the plate", "the time stamps" or "the bed"; empty: unchecked
  std::string not_checked;   ///< why a fixed lock could not be checked
  std::string warning;       ///< how a fixed lock contradicts the stack; empty: it does not

  [[nodiscard]] bool locked() const { return frames_per_cycle > 0; }
  /// Phase and cycle of a frame: its entry of `frames`, or, if that is empty, those of the PhaseLock.
  /// \param frame f >= 0
  [[nodiscard]] FramePhase at(std::int64_t frame) const;
  /// Cycles of the drive at which the frame was taken, since phase 0 of cycle 0. Absent if the frame is out
  /// of lock or nothing is locked.
  [[nodiscard]] std::optional<double> cycles_at(std::int64_t frame) const;
  /// Whether the frame belongs to a trajectory: it repeats no instant and is not out of lock.
  [[nodiscard]] bool is_used(std::int64_t frame) const;
};

/// The phases of a PhaseLock. Nothing is measured, so jitter and period are absent and no frame counts as
/// dropped.
PhaseTable fixed_phases(const PhaseLock& lock);

/// Sets phases, cycles and counts of missing and doubled frames.
/// \param ticks [frames] frame intervals since frame 0
/// \pre table.frames_per_cycle and table.first_phase are set
void set_phases(PhaseTable& table, std::span<const std::int64_t> ticks);

/// Takes the phases of these frames away. Missing and doubled frames in them, and at their ends, are no
/// longer counted.
/// \pre table.frames has an entry for each frame
void leave_out(PhaseTable& table, std::span<const FrameStretch> stretches);

/// "the plate does not follow the drive in 40 of 440 frames (0 to 39); they have no phase and are left out
/// of the trajectory"
std::string out_of_lock_in_words(const PhaseTable& table);

}  // namespace twincell::imaging
