#pragma once
/// \file
/// Writes and reads trajectories as H5MD 1.1 files, frame by frame. docs/h5md.md lists layout and names.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// Latest version of our additions to H5MD. A file states in /twincell@schema_version the lowest version
/// whose readers understand it: 2 if its drive has a ramp or a horizontal motion, which readers of version 1
/// would take for a steady vertical drive, otherwise 1. The reader rejects a newer version than this.
inline constexpr int kSchemaVersion = 2;

/// Writes a trajectory frame by frame under a temporary name.
class H5mdWriter : public TrajectorySink {
 public:
  /// \throws ConfigError if the output cannot be written (AtomicPath)
  H5mdWriter(const std::filesystem::path& path, TrajectoryInfo info);
  ~H5mdWriter() override;  ///< without finish() or finish_as_failed(), deletes the file
  H5mdWriter(const H5mdWriter&) = delete;
  H5mdWriter& operator=(const H5mdWriter&) = delete;

  /// \throws RunError if `frame.step` does not increase, a column has the wrong length, or the disk is full
  void append(const Frame& frame) override;
  /// Closes the file and gives it its final name.
  void finish();
  /// Marks the file as the output of a run that failed, for the reason `why`, closes it and gives it another
  /// name in the same folder.
  /// \returns its name, which is another one if a file that is not of a failed run has `name`
  std::filesystem::path finish_as_failed(const std::filesystem::path& name, const std::string& why);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads an H5MD file of this program, or of another one if it stores the step of each frame explicitly.
/// Reads the particle group `trajectory`, or the first one by name if there is no such group. Missing
/// elements are absent columns; a missing time is replaced by the step.
class H5mdReader : public TrajectorySource {
 public:
  /// \throws InputError if the file is missing, truncated, not HDF5, or not H5MD
  explicit H5mdReader(const std::filesystem::path& path);
  ~H5mdReader() override;
  H5mdReader(const H5mdReader&) = delete;
  H5mdReader& operator=(const H5mdReader&) = delete;

  [[nodiscard]] const TrajectoryInfo& info() const override;
  [[nodiscard]] std::size_t n_frames() const override;
  void read(std::size_t index, Frame& frame) const override;
  [[nodiscard]] std::string name() const override;

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Checks a file against H5MD 1.1 and our additions. Returns one sentence per fault; empty if the file
/// conforms. Every frame is read, so that a damaged chunk is found.
/// \throws InputError if the file is not HDF5 at all
std::vector<std::string> validate_h5md(const std::filesystem::path& path);

}  // namespace twincell
