#pragma once
/// \file
/// Reads a scene: its file, the preset and the calibration file that it names, and assignments.

#include <filesystem>
#include <string>
#include <vector>

#include "sim/scene/scene.hpp"

namespace twincell::sim {

/// Reads a scene. The key `preset` names one of preset_names(); the file's own keys override it. Every key
/// must be used: a key that the chosen laws, start or cell do not use is refused, or, if it comes from a
/// preset or a calibration file, it is removed and listed in Scene::void_keys.
/// \param assignments "section.key=value", which override everything else
/// \throws InputError if the file is missing; ConfigError naming file, line, key, value and bound
Scene read_scene(const std::filesystem::path& path, const std::vector<std::string>& assignments = {});
/// Reads a scene from text.
/// \param folder base of a relative start.from; empty: the working directory
Scene read_scene_text(const std::string& text, const std::string& name,
                      const std::vector<std::string>& assignments = {},
                      const std::filesystem::path& folder = {});

}  // namespace twincell::sim
