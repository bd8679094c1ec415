#pragma once
/// \file
/// Names in the files of trajectories that writer and reader share.

#include <string>
#include <vector>

namespace twincell::h5md {

/// Columns of /twincell/contact_forces/values.
inline const std::vector<std::string> kForceColumns = {
    "overlap",      "normal_x",           "normal_y",           "normal_z",
    "normal_force", "tangential_force_x", "tangential_force_y", "tangential_force_z"};
inline constexpr const char* kTemperature = "temperature_time_mean";
inline constexpr const char* kTemperatureCoarse = "temperature_time_mean_coarse";
inline constexpr const char* kWallNormalForce = "wall_normal_force_time_mean";
inline constexpr const char* kWallForce = "wall_force_time_mean";
inline constexpr const char* kContactStress = "contact_stress_time_mean";
inline constexpr const char* kKineticStress = "kinetic_stress_time_mean";
inline constexpr const char* kBeadContacts = "bead_contacts_time_mean";

}  // namespace twincell::h5md
