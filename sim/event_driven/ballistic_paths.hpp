#pragma once
/// \file
/// Free flight of many beads. In a freely falling frame all beads move on straight lines, so the first touch
/// of a pair is a root of a quadratic equation. SIMD solves it for several pairs at a time.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/system/cell_grid.hpp"
#include "trajectory/box.hpp"

namespace twincell::sim {

/// Free flight of one bead: r(t) = a + b t + g t^2/2. The gravity g is an argument of the functions.
struct BallisticPath {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();

  [[nodiscard]] Vec3 position(double t, const Vec3& gravity) const { return a + t * (b + 0.5 * t * gravity); }
  [[nodiscard]] Vec3 velocity(double t, const Vec3& gravity) const { return b + t * gravity; }
  /// The path that passes through r with velocity v at time t.
  static BallisticPath through(const Vec3& r, const Vec3& v, double t, const Vec3& gravity) {
    const Vec3 b = v - t * gravity;
    return {r - t * (b + 0.5 * t * gravity), b};
  }
  /// The same flight with the origin of time moved to t = `by`.
  [[nodiscard]] BallisticPath later(double by, const Vec3& gravity) const {
    return {position(by, gravity), velocity(by, gravity)};
  }
};

/// Paths of all beads, stored component by component for SIMD.
class BallisticPaths {
 public:
  /// \param period of x, y, z; 0: not periodic, otherwise at least twice the sum of any two radii
  BallisticPaths(const std::vector<double>& radii, int dimension, const std::array<double, 3>& period);

  [[nodiscard]] std::size_t size() const { return n_; }
  [[nodiscard]] BallisticPath operator[](std::size_t i) const {
    BallisticPath line;
    for (std::size_t k = 0; k < 3; ++k)
      line.a[static_cast<Eigen::Index>(k)] = a_[k][i], line.b[static_cast<Eigen::Index>(k)] = b_[k][i];
    return line;
  }
  /// Replaces the path of bead i.
  void put(std::size_t i, const BallisticPath& line) {
    for (std::size_t k = 0; k < 3; ++k)
      a_[k][i] = line.a[static_cast<Eigen::Index>(k)], b_[k][i] = line.b[static_cast<Eigen::Index>(k)];
  }
  [[nodiscard]] double radius(std::size_t i) const { return radius_[i]; }
  /// Time, t0, from which the path of a bead is valid: the first whole step after its present contact or
  /// cluster.
  double& valid_from(std::size_t i) { return from_[i]; }
  [[nodiscard]] double valid_from(std::size_t i) const { return from_[i]; }
  /// Shift from r to its periodic image nearest the origin.
  [[nodiscard]] Vec3 shift(const Vec3& r) const { return nearest_shift(r, period_); }

  /// The first touch of bead i with another bead if no path changes.
  struct Hit {
    double time;           ///< t0; infinite if there is no touch
    std::int32_t partner;  ///< -1 if there is no touch
    double until;          ///< after this time another periodic image may touch first; then search again
    bool overlap;          ///< another bead already overlaps, so free flight is impossible
  };
  /// The first touch of bead i after the time `now`, t0.
  [[nodiscard]] Hit first_hit(std::size_t i, double now) const;
  /// Appends to `found` the beads that touch a body of this radius on this path between two times, if they
  /// follow their own paths. The interval must be short. If the body is itself one of the beads, that bead is
  /// found too.
  void find_near(const BallisticPath& line, double radius, double begin, double end,
                 std::vector<std::int32_t>& found) const;

 private:
  std::size_t n_;
  int dimension_;
  std::array<double, 3> period_, per_;  ///< per: 1/period
  std::array<std::vector<double>, 3> a_, b_;
  std::vector<double> radius_, from_;
};

}  // namespace twincell::sim
