#pragma once
/// \file
/// The tables `[drive.ramp]` and `[drive.horizontal]` of a scene.

#include <cstdint>
#include <optional>

#include "core/config.hpp"
#include "sim/system/system.hpp"
#include "trajectory/drive.hpp"

namespace twincell::sim {

/// The keys of `[drive.ramp]`.
struct RampSpec {
  DriveSpec to;          ///< the drive at the end, as far as it is stated
  bool returns = false;  ///< the second half of the cycles leads back
};

/// Reads the table; absent without one.
std::optional<RampSpec> read_ramp(const ConfigSection& drive);

/// Makes the ramp. The stated quantities change linearly in time: the frequency, and one of amplitude, peak
/// velocity (also if K_m is stated) and Gamma. A frequency that `spec` does not state is constant; if `spec`
/// states no strength, the one that the drive states is constant.
/// \param begin the drive before the ramp, and `said` the keys that fix it
/// \param gravity magnitude of g, to which Gamma and K_m refer
/// \param first, cycles of the drive before the ramp, and its length
/// \param drive the table, for messages
/// \throws ConfigError if nothing changes, if more than one strength or more than one frequency is stated, if
/// the drive states no single strength that could stay, for a frequency that changes by more than a factor of
/// kLargestChange, for a ramp that returns in an odd number of cycles, or for a drive that is recorded or has
/// a horizontal motion
DriveRamp make_ramp(const RampSpec& spec, const Drive& begin, const DriveSpec& said, double gravity,
                    std::int64_t first, std::int64_t cycles, const ConfigSection& drive);
inline constexpr double kLargestChange = 100;

/// Number of cycles before the recorded ones: the envelope, then `discard`.
std::int64_t cycles_before(const Envelope& envelope, std::int64_t discard);

/// Reads `[drive.horizontal]`; absent without one.
/// \throws ConfigError for a number out of range
std::optional<HorizontalMotion> read_horizontal(const ConfigSection& drive);

}  // namespace twincell::sim
