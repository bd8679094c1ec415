#pragma once
/// \file
/// Quantities that a configuration states with their units (`drive.frequency_hz`, `cell.width_mm`), turned
/// into the reduced ones that everything else reads. The one place where laboratory units are converted.
///
/// | key                                                        | in laboratory units        | in reduced
/// units      |
/// |------------------------------------------------------------|----------------------------|-----------------------|
/// | drive.amplitude                                            | amplitude_mm               |
/// amplitude_sigma       | | drive.frequency                                            | frequency_hz |
/// frequency_per_t0      | | drive.omega                                                | omega_rad_s |
/// omega_per_t0          | | drive.peak_velocity                                        | peak_velocity_mm_s
/// | peak_velocity_v0      | | drive.gamma                                                |
/// peak_acceleration_m_s2, _g | gamma                 | | cell.width, cell.height, cell.depth | width_mm, ...
/// | width_sigma, ...      | | scale.sigma_m                                              | sigma_mm | - |

#include <string>

#include "analysis/trajectory/config.hpp"

namespace twincell {

/// Restates every quantity with a unit under its plain reduced key; complaints about it still name the
/// spelling and the line that the user wrote. `peak_acceleration_g` is in units of the scene's gravity.
/// \throws ConfigError for a value that is out of range; for a laboratory unit without the part of [scale]
///         that converts it; for two spellings of one quantity that differ by more than 1e-9 of it; and for a
///         plain drive.amplitude, frequency, omega or peak_velocity beside a [scale] that says sigma, since
///         nothing tells whether a laboratory's number is meant
void reduce_units(Config& config);

/// Removes from `config` every spelling of what "section.key=value" is about to state in its own words, of
/// omega and frequency and of gamma, k_m and peak_velocity those of each other.
void displace_spellings(Config& config, const std::string& assignment);

/// The configuration as TOML that means the same when it is read again: with a [scale] the drive is written
/// under its explicit reduced names. \pre reduce_units
std::string resolved_text(Config& config);

}  // namespace twincell
