#pragma once
/// \file
/// Detection store: the beads of all frames, on disk while a stack is tracked.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace twincell::imaging {

/// One bead of one frame, between detection and trajectory.
struct TrackedBead {
  double x_px = 0, y_px = 0, radius_px = 0;
  std::int64_t track = -1;
  bool tracer = false;
  bool ambiguous = false;                 ///< the link to the previous frame has a rival nearly as good
  double sigma_x_px = 0, sigma_y_px = 0;  ///< standard deviations of x and y
};

/// Frames of beads in an unnamed temporary file, which is deleted with the store, even after a crash. Memory:
/// 8 bytes per frame.
class DetectionStore {
 public:
  /// \param folder folder of the file; it must be writable and have room for 64 bytes per bead and frame.
  ///     Empty: the folder for temporary files
  /// \throws RunError if no file can be created there
  explicit DetectionStore(const std::filesystem::path& folder);
  /// Appends the beads of the next frame.
  /// \throws RunError if writing fails, for example because the disk is full
  void append(std::span<const TrackedBead> beads);
  /// Number of frames.
  [[nodiscard]] std::size_t size() const { return ends_.size(); }
  [[nodiscard]] bool empty() const { return ends_.empty(); }
  /// Number of beads in frame f.
  [[nodiscard]] std::size_t count(std::size_t f) const { return ends_[f] - (f > 0 ? ends_[f - 1] : 0); }
  /// The beads of frame f.
  /// \throws RunError if they cannot be read back
  [[nodiscard]] std::vector<TrackedBead> operator[](std::size_t f) const;

 private:
  struct Close {
    void operator()(int* descriptor) const;
  };
  std::filesystem::path folder_;
  std::unique_ptr<int, Close> file_;
  std::vector<std::uint64_t> ends_;  // number of beads up to and including frame f
};

}  // namespace twincell::imaging
