#pragma once
/// \file
/// Checkpoint: the state of a run in one HDF5 file, written completely or not at all.

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "sim/run/simulation.hpp"

namespace twincell::sim {

/// Version of the state file; files of any other version are refused.
inline constexpr int kCheckpointVersion = 4;

/// A finished file of frames that belongs to the state.
struct Segment {
  std::int64_t frames = 0;
  std::string sha256;
};

/// Everything that is needed to resume a run.
struct Checkpoint {
  std::string scene;       ///< resolved, as TOML
  std::string provenance;  ///< of the original run, JSON
  std::string program;     ///< version_line() of the program that wrote it
  std::vector<Segment> segments;
  RunState state;
};

/// Writes a temporary file in the same folder, flushes it to disk and renames it. The file contains a SHA-256
/// digest of all its numbers and texts.
/// \throws RunError
void write_checkpoint(const std::filesystem::path& path, const Checkpoint& checkpoint);

/// Reads a checkpoint and verifies its digest.
/// \throws InputError if it is missing, damaged in any number, or of another version
Checkpoint read_checkpoint(const std::filesystem::path& path);

/// Whether the provenance of a trajectory states this scene.
bool is_of_scene(const std::string& provenance_json, const Scene& scene);

/// Whether the file of start.from is none of the inputs in the provenance of a run. False if it was removed
/// since, because the run does not need it any more; the record of a drive has a key of its own.
bool has_other_start(const Scene& scene, const std::string& provenance_json);

/// Checks that a run of this scene with this program may continue from the checkpoint.
/// \throws ConfigError naming the first key in which the scenes differ, or both program versions
void require_same_run(const Scene& scene, const Checkpoint& checkpoint,
                      const std::filesystem::path& checkpoint_name);

}  // namespace twincell::sim
