#pragma once
/// \file
/// Reads the tables of a scene, each by itself. Checks that involve several tables: check_scene.hpp.

#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/config.hpp"
#include "sim/scene/scene.hpp"
#include "sim/scene/void_keys.hpp"

namespace twincell::sim {

/// Tables below [contact], and the walls to which each applies.
const std::vector<std::pair<std::string, std::vector<std::string>>>& wall_tables();

/// Each reads the keys of its table into the scene.
/// \param void_keys takes keys of a preset or a calibration file that have no effect
/// \param folder to which relative names of files refer
/// \throws ConfigError naming the key for a value out of range, for keys that contradict each other, and for
/// keys of something that the scene does not have
/// @{
/// \returns the magnitude of g as given, to which Gamma and K_m refer
double read_cell(const ConfigSection& s, Scene& scene, VoidKeys& void_keys);
/// \pre read_cell
void read_beads(const ConfigSection& s, Scene& scene, VoidKeys& void_keys);
/// \pre read_cell
void read_contact(const ConfigSection& s, Scene& scene, VoidKeys& void_keys);
/// \pre read_cell
/// \returns what states amplitude and frequency
DriveSpec read_drive(const ConfigSection& s, const std::filesystem::path& folder, Scene& scene);
/// \pre read_drive
void read_start(const ConfigSection& s, const std::filesystem::path& folder, Scene& scene,
                VoidKeys& void_keys);
/// Reads [time].
void read_time(const ConfigSection& s, Scene& scene);
/// Reads [until].
void read_until(const ConfigSection& s, Scene& scene);
/// Reads [effects].
void read_effects(const ConfigSection& s, Scene& scene);
/// Reads [scale].
void read_scale(const ConfigSection& s, Scene& scene);
/// Keys of the spread of sizes, if the start gives all sizes.
/// \pre read_beads, read_start
void refuse_void_spread(const ConfigSection& beads, const Scene& scene, VoidKeys& void_keys);
/// @}

}  // namespace twincell::sim
