#pragma once
/// \file
/// The class Trajectory of the Python module: one trajectory, in memory or in a file.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "core/file_identity.hpp"
#include "python/module.hpp"
#include "trajectory/formats/h5md_file.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::python {

/// Frames in memory, each shared with the arrays over it. Copies share the frames.
class SharedFrames : public TrajectorySource, public TrajectorySink {
 public:
  explicit SharedFrames(TrajectoryInfo info) : info_(std::move(info)) {}
  [[nodiscard]] const TrajectoryInfo& info() const override { return info_; }
  [[nodiscard]] std::size_t n_frames() const override { return frames_.size(); }
  void read(std::size_t index, Frame& frame) const override { frame = *frames_[index]; }
  [[nodiscard]] std::string name() const override { return "memory"; }
  void append(const Frame& frame) override { frames_.push_back(std::make_shared<const Frame>(frame)); }
  /// Adds a frame at the end.
  void append(std::shared_ptr<const Frame> frame) { frames_.push_back(std::move(frame)); }
  [[nodiscard]] const std::vector<std::shared_ptr<const Frame>>& frames() const { return frames_; }

 private:
  TrajectoryInfo info_;
  std::vector<std::shared_ptr<const Frame>> frames_;
};

/// Refuses an output that is one of the files that the call reads, under any name.
/// \throws ConfigError naming the output
void require_no_input(const std::filesystem::path& output, const std::vector<std::filesystem::path>& inputs);

/// A trajectory, and of a file the frame that was read last. An array of a column keeps its frame alive.
class Trajectory {
 public:
  /// A file as it was when it was opened.
  struct File {
    std::filesystem::path path;  ///< absolute
    FileIdentity identity;
  };

  explicit Trajectory(SharedFrames frames)
      : source_(std::make_unique<SharedFrames>(std::move(frames))),
        memory_(static_cast<const SharedFrames*>(source_.get())) {}
  /// \throws InputError if there is no such file, or as H5mdReader
  explicit Trajectory(const std::filesystem::path& file);

  [[nodiscard]] const TrajectorySource& source() const { return *source_; }
  [[nodiscard]] const TrajectoryInfo& info() const { return source_->info(); }
  [[nodiscard]] std::size_t n_frames() const { return source_->n_frames(); }
  /// The file, as long as it is the one that was opened; nothing in memory, and after the
  /// file was replaced, changed or removed.
  [[nodiscard]] std::optional<File> file() const;
  /// Frame `index`.
  /// \pre index < n_frames()
  std::shared_ptr<const Frame> frame(std::size_t index);

 private:
  std::unique_ptr<TrajectorySource> source_;
  const SharedFrames* memory_ = nullptr;  ///< source_, if it is in memory
  std::optional<File> file_;
  std::shared_ptr<const Frame> last_;
  std::size_t last_index_ = 0;
};

/// The trajectory of a file (H5MD).
/// \throws InputError as H5mdReader, which for a file of another program, a scene and a folder names the
/// function that makes a trajectory of it
std::shared_ptr<Trajectory> open_trajectory(const std::filesystem::path& path);

/// The trajectory of an argument: a Trajectory, or the name of a file.
/// \throws TypeError for anything else
std::shared_ptr<Trajectory> trajectory_of(const py::handle& said);

/// Frames of points (T, N, 2 or 3), or one of (N, 2 or 3), as a trajectory in memory. Each counts as a cycle,
/// so that correlations over cycles are over frames.
/// \param box as box_of
/// \param unwrapped positions along a period are unwrapped
std::shared_ptr<Trajectory> trajectory_of_points(const py::object& points, const py::object& box,
                                                 bool unwrapped);

}  // namespace twincell::python
