#pragma once
/// \file
/// Provenance of a result, stored in every output.

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

/// What a verb records about its run. `to_json` adds version, commit, compiler, library versions, time in UTC
/// and processor. No host or user name is recorded.
struct Provenance {
  std::string command_line;
  std::string config;  ///< resolved text of the scene or cell; empty if there is none
  std::string plan;    ///< plan of a simulation: what it computes and why, JSON; empty if there is none
  std::optional<std::uint64_t> seed;
  int threads = 1;
  std::vector<std::filesystem::path> inputs;  ///< size and SHA-256 of each are recorded

  /// \throws InputError if an input cannot be read
  [[nodiscard]] std::string to_json() const;
};

}  // namespace twincell
