#pragma once
/// \file
/// Trajectories as H5MD 1.1 files (layout and every name: docs/h5md.md). Streaming both ways.

#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// Version of our additions to H5MD, stored as /twincell@schema_version; readers refuse a newer one.
inline constexpr int kSchemaVersion = 1;

/// Writes a trajectory frame by frame under a temporary name.
class H5mdWriter : public TrajectorySink {
 public:
  /// \throws ConfigError if the place cannot be written to
  H5mdWriter(const std::filesystem::path& path, TrajectoryInfo info);
  ~H5mdWriter() override;  ///< without finish(): the file disappears
  H5mdWriter(const H5mdWriter&) = delete;
  H5mdWriter& operator=(const H5mdWriter&) = delete;

  /// \throws RunError if `frame.step` does not increase, a column has the wrong length, or the disk is full
  void append(const Frame& frame) override;
  /// Closes the file and gives it its name.
  void finish();
  /// Closes the file and gives it another name in the same folder: what a run that went wrong leaves behind.
  void finish_as(const std::filesystem::path& other_name);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

/// Reads an H5MD file; ours, or anyone's with explicit step and time and one particle group. What is missing
/// is absent.
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

/// Checks a file against H5MD 1.1 and our additions. Returns one sentence per fault; empty means conforming.
/// Every frame is read, so that a damaged chunk is found. \throws InputError if the file is not HDF5 at all
std::vector<std::string> validate_h5md(const std::filesystem::path& path);

}  // namespace twincell
