#pragma once
/// \file
/// Beads of all frames, on disk while a stack is worked on.

#include <cstdint>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

namespace twincell {

/// One bead of one frame on its way to a trajectory.
struct TrackedBead {
  double x_px = 0, y_px = 0, radius_px = 0;
  std::int64_t track = -1;
  bool tracer = false;
  bool ambiguous = false;                 ///< the link to the frame before has a rival nearly as good
  double sigma_x_px = 0, sigma_y_px = 0;  ///< standard deviations of x and y
};

/// Frames of beads in a file without a name, which is gone when the store is, whatever happens. Memory is 8
/// bytes per frame.
class DetectionStore {
 public:
  /// \param folder where the file lies; it must be writable and have room for 64 bytes per bead and frame
  /// \throws RunError if no file can be made there
  explicit DetectionStore(const std::filesystem::path& folder);
  /// \throws RunError if the disk is full
  void append(std::span<const TrackedBead> beads);
  /// Number of frames.
  [[nodiscard]] std::size_t size() const { return ends_.size(); }
  [[nodiscard]] bool empty() const { return ends_.empty(); }
  /// Frame f. \throws RunError if it cannot be read back
  [[nodiscard]] std::vector<TrackedBead> operator[](std::size_t f) const;

 private:
  struct Close {
    void operator()(int* descriptor) const;
  };
  std::filesystem::path folder_;
  std::unique_ptr<int, Close> file_;
  std::vector<std::uint64_t> ends_;  // beads up to and with frame f
};

}  // namespace twincell
