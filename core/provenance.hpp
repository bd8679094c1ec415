#pragma once
/// \file
/// Where a result comes from: stored in every output.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace twincell {

/// One line: "twincell 0.1.0 (abc1234)".
std::string version_line();
/// Version, commit, compiler, library versions and processor as a JSON object.
std::string version_json();

/// What a verb knows of its own run. The rest (version, commit, time in UTC, processor) is added by
/// `to_json`. No host or user name is recorded.
struct Provenance {
  std::string command_line;
  std::string config;  ///< resolved scene or cell text; empty if none
  std::string plan;    ///< what a simulation computes and why, JSON; empty if none
  std::optional<std::uint64_t> seed;
  int threads = 1;
  std::vector<std::filesystem::path> inputs;  ///< size and SHA-256 of each are recorded

  /// \throws InputError if an input cannot be read
  [[nodiscard]] std::string to_json() const;
};

}  // namespace twincell
