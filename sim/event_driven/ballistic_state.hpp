#pragma once
/// \file
/// Ballistic state: the paths, spins and masses of all beads during event-driven motion, with the walls and
/// gravity that they move in. Times are in t0 and count from the start of a period of the drive; lengths are
/// in sigma, velocities in sqrt(g sigma).

#include <array>
#include <cstddef>
#include <cstdint>
#include <utility>
#include <vector>

#include "sim/event_driven/ballistic_paths.hpp"
#include "sim/event_driven/binary_collision.hpp"
#include "sim/event_driven/cluster.hpp"
#include "sim/scene/plan.hpp"

namespace twincell::sim {

/// A bead on or near a path between two times.
struct PathInterval {
  std::int32_t bead;
  BallisticPath line;
  double radius;  ///< radius of the bead plus its largest deviation from the path
  double begin, end;
};

/// A contact of two bodies that is in progress or has just ended. The paths of its beads are those after the
/// contact.
struct BinaryContact {
  std::int32_t i, j;          ///< i < j; or j = -1 - w for wall w
  double begin, middle, end;  ///< of the contact
  double from, until;         ///< the enclosing whole steps: no other body may touch its beads in between
  /// Largest deviation of each bead from its path in `before` until `middle`, and from its path after the
  /// contact from then on, sigma.
  std::array<double, 2> early, late;
  /// Radius of a ball that contains both beads from `from` to `until` and moves along before[0].
  double about;
  RelativeMotion motion;  ///< at `begin`
  Vec3 shift = Vec3::Zero();
  std::array<BallisticPath, 2> before;
  std::array<Vec3, 2> rim;  ///< R w before the contact
};

/// A cluster of beads until they have parted. Their paths are those after the cluster.
struct ClusterRun {
  Cluster cluster;
  double from, until;                 ///< whole steps: no other body may touch them in between
  std::vector<BallisticPath> before;  ///< path of each at `from`, without the contacts
};

/// State of a bead at one instant.
struct BeadState {
  Vec3 r, v, rim;
};

/// Everything that determines the motion of the beads between contacts. It refers to the plan, which must
/// outlive it.
struct BallisticState {
  /// All beads of a system, at a time in its period, t0.
  BallisticState(const Plan& plan, const System& s, double time);

  /// From t on, bead i moves on the path of bead k of `s`.
  void set_path(std::size_t i, const System& s, std::size_t k, double t);
  /// The path in free flight of a bead with this position and velocity at time t.
  [[nodiscard]] BallisticPath path_of(const Bead& b, double t) const {
    return BallisticPath::through(centre_of(b), Vec3(b.vx, b.vy, b.vz), t, gravity);
  }
  /// Moves the origin of time to t = `by`, t0.
  void move_origin(double by);

  /// Plate displacement, sigma.
  [[nodiscard]] Vec3 plate(double t) const;
  /// Plate velocity, sqrt(g sigma).
  [[nodiscard]] Vec3 plate_velocity(double t) const;
  /// A point of the surface of a wall, and its velocity.
  [[nodiscard]] std::pair<Vec3, Vec3> surface(const Wall& wall, double t) const;
  /// Whether bead i on its path overlaps a wall at time t.
  [[nodiscard]] bool in_wall(std::size_t i, const Wall& wall, double t) const;
  /// Time, t0, at which a bead on its path first touches a wall, from a time on. Infinite if it never does,
  /// or not before `needed`.
  [[nodiscard]] double wall_touch(std::size_t i, const Wall& wall, double from, double needed) const;
  /// Whether a body may touch a wall during an interval, which must be short.
  [[nodiscard]] bool reaches(const PathInterval& p, const Wall& wall) const;

  /// Distance of the centres of two bodies on their paths at time t, sigma.
  [[nodiscard]] double distance(const PathInterval& p, const PathInterval& q, double t) const;
  /// Whether two bodies on their paths may touch between two times.
  [[nodiscard]] bool come_near(const PathInterval& p, const PathInterval& q, double begin, double end) const;

  /// The contact of bead i with bead j, or with wall -1 - j.
  [[nodiscard]] CollisionSetting setting(std::int32_t i, std::int32_t j) const;
  /// Relative motion of the bodies of a contact on their paths before it; sets its shift.
  [[nodiscard]] RelativeMotion relative_motion(BinaryContact& c, double t) const;
  /// States of both beads of a contact (of one, at a wall) from their relative motion at t.
  [[nodiscard]] std::array<BeadState, 2> states_of(const BinaryContact& c, const RelativeMotion& m,
                                                   double t) const;

  const Plan* plan;
  BallisticPaths paths;
  std::vector<Vec3> rim;           ///< R w, after the present contact
  std::vector<double> mass, turn;  ///< turn: R^2/I
  std::vector<Wall> walls;
  Vec3 gravity;
  Eigen::Index axis;
  double amplitude, omega;
};

}  // namespace twincell::sim
