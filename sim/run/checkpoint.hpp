#pragma once
/// \file
/// A run's state as one HDF5 file, whole or not at all.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/run/simulation.hpp"

namespace twincell::sim {

/// Version of the state file; another one is refused.
inline constexpr int kCheckpointVersion = 3;

/// A finished file of frames that the state counts on.
struct Segment {
  std::int64_t frames = 0;
  std::string sha256;
};

/// What a run can be taken up from.
struct Checkpoint {
  std::string scene;       ///< resolved, as TOML
  std::string provenance;  ///< of the run that began, JSON
  std::string program;     ///< version_line() of the program that wrote it
  std::vector<Segment> segments;
  RunState state;
};

/// Written beside its name, brought to the disk, renamed. A SHA-256 over all numbers and texts goes with it.
/// \throws RunError
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// \throws InputError if it is missing, damaged in any number, or of another version
Checkpoint read_checkpoint(const std::filesystem::path& path);

/// Whether a run of this scene by this program may go on from the checkpoint.
/// \throws ConfigError naming the first key in which the scenes differ, or both programs
void require_same_run(const Scene& scene, const Checkpoint& checkpoint,
                      const std::filesystem::path& checkpoint_name);

}  // namespace twincell::sim
