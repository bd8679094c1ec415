#pragma once
/// \file
/// Quantities that a configuration states with their units (`drive.frequency_hz`, `cell.width_mm`), turned
/// into the reduced ones that everything else reads. The one place where laboratory units are converted.
///
///     key                           in laboratory units              in reduced units
///     scale.sigma_m                 sigma_mm
///     drive.amplitude               amplitude_mm                     amplitude_sigma
///     drive.frequency               frequency_hz                     frequency_per_t0
///     drive.omega                   omega_rad_s                      omega_per_t0
///     drive.peak_velocity           peak_velocity_mm_s               peak_velocity_v0
///     drive.gamma                   peak_acceleration_m_s2, _g       gamma
///     cell.width, height, depth     width_mm, ...                    width_sigma, ...
///     beads.radius                  radius_mm, diameter_mm           radius_sigma, diameter_sigma
///     beads.intruder.radius         radius_mm, diameter_mm           radius_sigma, diameter_sigma
///     beads.intruder.x, y, z        x_mm, ...                        x_sigma, ...

#include <string>

#include "core/config.hpp"
#include "trajectory/units.hpp"

namespace twincell {

/// What a number is divided by to be reduced.
enum class Unit { one, per_mille, length_mm, time_us, rate_per_s, velocity_mm_s, acceleration_m_s2 };

/// The number in reduced units. \throws ConfigError at `where` if the scale does not say what converts it
double reduced_quantity(double value, Unit unit, const Scale& scale, const Where& where);

/// \throws ConfigError always: the number at `where` has no unit although `scale` says the laboratory's
/// scale; the sentence offers both spellings
[[noreturn]] void refuse_bare(const Where& where, double value, const std::string& scale,
                              const std::string& reduced, const std::string& physical);

/// Restates every quantity with a unit under its plain reduced key; complaints about it still name the
/// spelling and the line that the user wrote. `peak_acceleration_g` is in units of the scene's gravity.
/// \throws ConfigError for a value that is out of range; for a laboratory unit without the part of [scale]
///         that converts it; for two spellings of one quantity; and for a plain key of the table above beside
///         a [scale] that says sigma, gamma excepted, since nothing tells whether a laboratory's number is
///         meant
void reduce_units(Config& config);

/// Removes from `config` every spelling of what "section.key=value" is about to state in its own words, of
/// omega and frequency and of gamma, k_m and peak_velocity those of each other.
void displace_spellings(Config& config, const std::string& assignment);

/// The configuration as TOML that means the same when it is read again: with a [scale] the quantities of the
/// table above are written under their explicit reduced names. \pre reduce_units
std::string resolved_text(Config& config);

}  // namespace twincell
