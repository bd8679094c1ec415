#pragma once
/// \file
/// Shutter: positions of beads and plate shortly before and after a stored frame.

#include <optional>

#include "trajectory/trajectory.hpp"

namespace twincell::imaging {

/// A frame, its neighbours (either may be absent), and when and how brightly it is exposed.
struct Exposure {
  const Frame* before = nullptr;
  const Frame* now = nullptr;
  const Frame* after = nullptr;
  double late = 0;  ///< delay of the picture after the frame's own time, t0
  double lamp = 1;  ///< relative brightness of the lamp
};

/// Interpolates positions between frames. With velocities: the cubic through the positions and velocities of
/// both frames (exact in free flight), or a straight line if no neighbour is close enough in time. Without
/// velocities: the parabola through three frames or the line through two; a bead without a neighbour frame
/// stays at rest.
class Shutter {
 public:
  explicit Shutter(const TrajectoryInfo& info);
  /// Position of a slot at `tau` after the frame's own time, t0.
  /// \pre the slot is filled in exposure.now
  [[nodiscard]] Vec3 position(const Exposure& exposure, std::size_t slot, double tau) const;
  /// Plate height likewise: from the drive and the frame's phase, or from the frames if these are unknown.
  [[nodiscard]] double plate(const Exposure& exposure, double tau) const;
  /// Checks that paths can be interpolated: the trajectory has velocities, or frames close enough in time.
  /// \throws ConfigError naming the option that needs paths
  static void require_paths(const TrajectoryInfo& info, const char* option);

 private:
  bool velocities_;
  std::optional<Drive> drive_;
  int phases_per_cycle_;
  double longest_gap_;
};

}  // namespace twincell::imaging
