#pragma once
/// \file
/// Converts configuration keys with units (`drive.frequency_hz`, `cell.width_mm`) to the plain reduced keys,
/// which all other code reads. Laboratory units of a configuration are converted only here.
///
///     key                           in laboratory units              in reduced units
///     scale.sigma_m                 sigma_mm
///     drive.amplitude               amplitude_mm                     amplitude_sigma
///     drive.frequency               frequency_hz                     frequency_per_t0
///     drive.omega                   omega_rad_s                      omega_per_t0
///     drive.cutoff                  cutoff_hz                        cutoff_per_t0
///     drive.peak_velocity           peak_velocity_mm_s               peak_velocity_v0
///     drive.gamma                   peak_acceleration_m_s2, _g       gamma
///     cell.width, height, depth     width_mm, ...                    width_sigma, ...
///     beads.radius                  radius_mm, diameter_mm           radius_sigma, diameter_sigma
///     beads.intruder.radius         radius_mm, diameter_mm           radius_sigma, diameter_sigma
///     beads.intruder.x, y, z        x_mm, ...                        x_sigma, ...

#include <string>
#include <vector>

#include "core/config.hpp"
#include "trajectory/units.hpp"

namespace twincell {

/// Unit of a number, which selects its conversion to reduced units.
enum class Unit { one, per_mille, length_mm, time_us, rate_per_s, velocity_mm_s, acceleration_m_s2 };

/// The number in reduced units.
/// \throws ConfigError at `where` if `scale` lacks a number that the conversion requires
double reduced_quantity(double value, Unit unit, const Scale& scale, const Where& where);

/// \throws ConfigError always: the number at `where` has no unit although the key `scale` sets the laboratory
/// scale. The message names the `reduced` and the `physical` key as alternatives.
[[noreturn]] void refuse_bare(const Where& where, double value, const std::string& scale,
                              const std::string& reduced, const std::string& physical);

/// Replaces every key with a unit by its plain reduced key. Error messages about the quantity still name the
/// key and the line that the user wrote. `peak_acceleration_g` is in units of the scene's gravity.
/// \throws ConfigError for a value out of range; for a laboratory unit whose conversion requires an absent
/// key of [scale]; for two spellings of one quantity; and for a plain key of the table above except gamma,
/// since its unit is then ambiguous, if [scale] sets sigma, or if it sets gravity and the key is no length
void reduce_units(Config& config);

/// Prepares the assignment "section.key=value": removes from `config` every spelling of the quantity that it
/// sets. omega and frequency count as one quantity here, and so do gamma, k_m and peak_velocity.
void displace_spellings(Config& config, const std::string& assignment);

/// Two of amplitude, frequency and strength (gamma, k_m or peak velocity) determine a drive. Where
/// assignments to `drive` would make three, removes from `config` those that they do not set, in every
/// spelling; of one assignment and two stated quantities the frequency stays. An assigned frequency does not
/// tell which of the two others stays, and removes none.
/// \pre displace_spellings was called for each assignment
void displace_third_quantity(Config& config, const std::vector<std::string>& assignments);

/// The configuration as TOML that has the same meaning when it is read again. Quantities whose plain keys
/// reduce_units refuses are written under their explicit reduced keys.
/// \pre reduce_units was called
std::string resolved_text(Config& config);

}  // namespace twincell
