#pragma once
/// \file
/// Keys that a scene does not use.

#include <algorithm>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/config.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::sim {

/// Collects keys that the scene does not use. A key that the user wrote is refused. A key from a preset or a
/// calibration file gives way to the user's choice; it is removed and listed in Scene::void_keys.
class VoidKeys {
 public:
  /// \param lower names of the preset and of the calibration file, as they appear in messages
  VoidKeys(Config& config, std::vector<std::string> lower, std::vector<VoidKey>& told)
      : config_(config), lower_(std::move(lower)), told_(told) {}

  /// Refuses keys of something that the scene does not have.
  /// \param complaint a sentence
  void refuse(const ConfigSection& s, const std::vector<std::string>& keys, const std::string& complaint) {
    std::optional<Where> first;
    for (const auto& key : keys) {
      if (!s.has(key)) continue;
      const Where where = s.where(key);
      if (std::find(lower_.begin(), lower_.end(), where.file) == lower_.end()) {
        if (!first) first = where;
        continue;
      }
      told_.push_back({where.key, where.file, complaint});
      config_.erase(where.key);
    }
    if (first) throw ConfigError(*first, complaint);
  }

 private:
  Config& config_;
  std::vector<std::string> lower_;
  std::vector<VoidKey>& told_;
};

}  // namespace twincell::sim
