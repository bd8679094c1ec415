#pragma once
/// \file
/// How the layers of a scene combine: preset, calibration file, the user's file, assignments of the command
/// line. A key of an upper layer replaces the same key of a lower one, and others that state the same
/// quantity.

#include <cstddef>
#include <string>
#include <vector>

#include "core/config.hpp"

namespace twincell::sim {

/// Keys of [drive] that together state amplitude and frequency.
const std::vector<std::string>& drive_words();

/// How many of drive_words() a layer states.
std::size_t count_drive_words(const Config& config);

/// Removes from `lower` the amplitude of the drive, however it is stated, if `upper` names a record: its
/// motion has an amplitude of its own, which a stated one would scale.
void yield_to_record(Config& lower, const Config& upper);

/// Removes keys from `lower` that `upper` replaces by an equivalent key: restitution replaces gamma_n, layers
/// the count, frequency omega.
void displace(Config& lower, const Config& upper);

/// Applies assignments to a scene. An assigned K_m replaces a Gamma of the scene, and the amplitude of a
/// scene that states amplitude and frequency; assignments that contradict each other are refused later.
void assign(Config& config, const std::vector<std::string>& assignments);

/// Divides every drive.peak_acceleration_m_s2 by `cell.gravity`, the gravity of the run in units of that of
/// the scale. Gamma refers to the gravity of the run; reduce_units(), which is called afterwards and knows no
/// scene, divides by the gravity of the scale alone.
void refer_to_gravity(Config& config);

}  // namespace twincell::sim
