#pragma once
/// \file
/// Files of an unfinished run: its state, and the frames so far as finished H5MD files.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/error.hpp"
#include "sim/run/checkpoint.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::sim {

/// A checkpoint or its frames could not be written. Exit code 5 if an older checkpoint exists from which the
/// run can be resumed, otherwise 1.
class NotSaved : public Error {
 public:
  using Error::Error;
};

/// Folder with `state.h5` and with `segment-0001.h5` ..., which contain the frames between one save and the
/// next. A segment is on disk under its final name before the state that refers to it, so at every instant
/// the folder contains a complete run up to some step. Anything that a killed run wrote after that step is
/// removed when the folder is opened again.
class CheckpointFolder : public TrajectorySink {
 public:
  /// Checkpoint folder of an output file: NAME.checkpoint.
  static std::filesystem::path of(const std::filesystem::path& output);
  /// Whether a folder contains a state to resume from, intact or damaged.
  static bool holds_a_run(const std::filesystem::path& folder);

  /// Creates the folder, or opens it and reads its contents.
  /// \param make_provenance provenance of a new run; a resumed run keeps its original provenance
  /// \throws ConfigError if the folder cannot be created, is a link, contains files of others, belongs to
  /// another scene or program version, or is in use by another process; InputError if it is damaged
  CheckpointFolder(std::filesystem::path folder, const Scene& scene,
                   const std::function<std::string()>& make_provenance);
  ~CheckpointFolder() override;
  CheckpointFolder(const CheckpointFolder&) = delete;
  CheckpointFolder& operator=(const CheckpointFolder&) = delete;

  /// Whether there is a state to resume from; it is then checkpoint().state.
  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] const Checkpoint& checkpoint() const { return checkpoint_; }
  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

  /// Metadata of the coming frames; call before the first append().
  void announce(TrajectoryInfo info) { info_ = std::move(info); }
  /// \throws NotSaved
  void append(const Frame& frame) override;
  /// Finishes the segment and writes the state.
  /// \throws NotSaved
  void save(RunState state);
  /// Appends all frames to `out`, including those since the last save, calls `finish`, and removes the
  /// folder.
  /// \throws NotSaved; the folder is then kept
  void gather(TrajectorySink& out, const std::function<void()>& finish);
  /// Removes the files of this class, and the folder if it is then empty.
  void remove();

 private:
  [[nodiscard]] std::filesystem::path segment(std::size_t index) const;
  void finish_segment();
  template <class Work>
  void saving(Work work) const;
  /// The segments that follow those of the state without a gap.
  [[nodiscard]] std::vector<std::filesystem::path> later_segments() const;
  /// \throws ConfigError naming a file that a run of this scene has not left, if it would be removed or if
  /// there is no state
  void require_own_files(const Scene& scene) const;
  void remove_strays() const;

  std::filesystem::path folder_;
  int lock_ = -1;
  bool found_ = false;
  Checkpoint checkpoint_;
  TrajectoryInfo info_;
  std::unique_ptr<H5mdWriter> writer_;
  std::int64_t frames_ = 0;  ///< number of frames in the unfinished segment
};

}  // namespace twincell::sim
