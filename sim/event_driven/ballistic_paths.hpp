#pragma once
/// \file
/// Free flight of many beads. In a frame that falls with them all beads fly straight, so which two touch
/// first is a quadratic equation for each pair, vectors of them at a time.

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "sim/system/cell_grid.hpp"
#include "trajectory/box.hpp"

namespace twincell::sim {

/// r(t) = a + b t + g t^2/2.
struct BallisticPath {
  Vec3 a = Vec3::Zero(), b = Vec3::Zero();

  [[nodiscard]] Vec3 position(double t, const Vec3& gravity) const { return a + t * (b + 0.5 * t * gravity); }
  [[nodiscard]] Vec3 velocity(double t, const Vec3& gravity) const { return b + t * gravity; }
  /// Through r at v at time t.
  static BallisticPath through(const Vec3& r, const Vec3& v, double t, const Vec3& gravity) {
    const Vec3 b = v - t * gravity;
    return {r - t * (b + 0.5 * t * gravity), b};
  }
  /// The same flight with a clock that shows `by` less.
  [[nodiscard]] BallisticPath later(double by, const Vec3& gravity) const {
    return {position(by, gravity), velocity(by, gravity)};
  }
};

/// Lines of all beads, laid out for vectors.
class BallisticPaths {
 public:
  /// \param period of x, y, z; 0: not periodic, else at least twice the sum of any two radii
  BallisticPaths(const std::vector<double>& radii, int dimension, const std::array<double, 3>& period);

  [[nodiscard]] std::size_t size() const { return n_; }
  [[nodiscard]] BallisticPath operator[](std::size_t i) const {
    BallisticPath line;
    for (std::size_t k = 0; k < 3; ++k)
      line.a[static_cast<Eigen::Index>(k)] = a_[k][i], line.b[static_cast<Eigen::Index>(k)] = b_[k][i];
    return line;
  }
  void put(std::size_t i, const BallisticPath& line) {
    for (std::size_t k = 0; k < 3; ++k)
      a_[k][i] = line.a[static_cast<Eigen::Index>(k)], b_[k][i] = line.b[static_cast<Eigen::Index>(k)];
  }
  [[nodiscard]] double radius(std::size_t i) const { return radius_[i]; }
  /// From when on a bead's line holds: the end of a contact that goes on now.
  double& valid_from(std::size_t i) { return from_[i]; }
  [[nodiscard]] double valid_from(std::size_t i) const { return from_[i]; }
  /// From r to the nearest of its images.
  [[nodiscard]] Vec3 shift(const Vec3& r) const { return nearest_shift(r, period_); }

  /// The first touch of bead i with another, if all fly on.
  struct Hit {
    double time;           ///< infinite if there is none
    std::int32_t partner;  ///< -1 if there is none
    double until;          ///< beyond, other periodic images may come first: look again
    bool overlap;          ///< another bead already overlaps: no flight
  };
  [[nodiscard]] Hit first_hit(std::size_t i, double now) const;
  /// Appends to `found` the beads with whose lines a body of this radius on this line comes into touch
  /// between two times, whose difference is short. Its own bead, if it is one of these, is found too.
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
