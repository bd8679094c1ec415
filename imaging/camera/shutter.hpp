#pragma once
/// \file
/// What the shutter sees: where beads and plate are a little before and after a stored frame.

#include <optional>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// A frame and its neighbours. A neighbour may be absent.
struct Moment {
  const Frame* before = nullptr;
  const Frame* now = nullptr;
  const Frame* after = nullptr;
  double late = 0;  ///< the picture is taken this much after the frame's own time, t0
  double lamp = 1;  ///< light, relative
};

/// Positions between frames. With velocities: the cubic through both frames' positions and velocities (exact
/// in free flight), or a straight line where there is no near neighbour. Without: the parabola through three
/// frames, the line through two. A bead on its own stays.
class Shutter {
 public:
  explicit Shutter(const TrajectoryInfo& info);
  /// Position of a slot at `tau` after the frame's own time, t0. Needs the slot filled in moment.now.
  [[nodiscard]] Vec3 position(const Moment& moment, std::size_t slot, double tau) const;
  /// Plate height likewise: from the drive and the frame's phase; from the frames where those are unknown.
  [[nodiscard]] double plate(const Moment& moment, double tau) const;
  /// Whether paths can be drawn at all: velocities, or frames close enough to connect.
  /// \throws ConfigError naming the option that needs them
  static void require_paths(const TrajectoryInfo& info, const char* option);

 private:
  bool velocities_;
  std::optional<Drive> drive_;
  int phases_per_cycle_;
  double longest_gap_;
};

}  // namespace twincell
