#pragma once
/// \file
/// What an unfinished run leaves on the disk: its state, and its frames so far as finished H5MD files.

#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <string>

#include "core/error.hpp"
#include "sim/run/checkpoint.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::sim {

/// The disk did not take a checkpoint or its frames. Exit code 5 if there is an older one to go on from,
/// otherwise 1.
class NotSaved : public Error {
 public:
  using Error::Error;
};

/// `state.h5`, and `segment-0001.h5` ... with the frames between one save and the next. A segment is on the
/// disk under its name before the state that counts it, so the folder holds a whole run up to some step at
/// every instant. What a killed run wrote beyond that is removed when the folder is taken up again.
class CheckpointFolder : public TrajectorySink {
 public:
  /// The folder of an output: NAME.checkpoint.
  static std::filesystem::path of(const std::filesystem::path& output);
  /// Whether a folder holds a state to go on from, whole or damaged.
  static bool holds_a_run(const std::filesystem::path& folder);

  /// Makes the folder, or takes up what it holds.
  /// \param make_provenance of the run if it begins now; one taken up keeps that which it began with
  /// \throws ConfigError if it cannot be made, belongs to another scene or program version, or another
  /// process works in it; InputError if it is damaged
  CheckpointFolder(std::filesystem::path folder, const Scene& scene,
                   const std::function<std::string()>& make_provenance);
  ~CheckpointFolder() override;
  CheckpointFolder(const CheckpointFolder&) = delete;
  CheckpointFolder& operator=(const CheckpointFolder&) = delete;

  /// Whether there is a state to go on from: then checkpoint().state.
  [[nodiscard]] bool found() const { return found_; }
  [[nodiscard]] const Checkpoint& checkpoint() const { return checkpoint_; }
  [[nodiscard]] const std::filesystem::path& path() const { return folder_; }

  /// What the frames to come are of; call before the first.
  void announce(TrajectoryInfo info) { info_ = std::move(info); }
  /// \throws NotSaved
  void append(const Frame& frame) override;
  /// Finishes the segment and writes the state. \throws NotSaved
  void save(RunState state);
  /// Hands over all frames, those since the last save too, then lets them be finished, and goes.
  /// \throws NotSaved; the folder then stays
  void gather(TrajectorySink& out, const std::function<void()>& finish);
  /// Removes what is ours, and the folder if nothing else is in it.
  void remove();

 private:
  [[nodiscard]] std::filesystem::path segment(std::size_t index) const;
  void finish_segment();
  template <class Work>
  void saving(Work work) const;
  void remove_strays() const;

  std::filesystem::path folder_;
  int lock_ = -1;
  bool found_ = false;
  Checkpoint checkpoint_;
  TrajectoryInfo info_;
  std::unique_ptr<H5mdWriter> writer_;
  std::int64_t frames_ = 0;  ///< in the writer
};

}  // namespace twincell::sim
