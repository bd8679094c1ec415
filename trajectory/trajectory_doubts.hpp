#pragma once
/// \file
/// Signs that the numbers of a trajectory mean something else than its reader believes: beads beneath the
/// plate, velocities or radii that contradict the positions, single beads that jump, beads that exchange
/// their places, beads that are listed twice.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell {

/// Watches the frames of a trajectory in their order.
class TrajectoryDoubts {
 public:
  /// \param info outlives this object
  explicit TrajectoryDoubts(const TrajectoryInfo& info) : info_(info) {}
  void watch(const Frame& frame);
  /// What is doubtful in the frames so far, in sentences without a full stop.
  [[nodiscard]] std::vector<std::string> sentences() const;

 private:
  void watch_plate(const Frame& frame);
  void watch_steps(const Frame& frame);
  void watch_spacing(const Frame& frame);
  /// What contradicts the velocities, in sentences.
  [[nodiscard]] std::vector<std::string> doubts_of_velocities() const;
  /// Says that the velocities have another sign or other axes than the moves; empty if they have not.
  [[nodiscard]] std::string turned_velocities() const;

  const TrajectoryInfo& info_;
  Frame before_;
  std::size_t frames_ = 0;
  std::size_t all_ = 0, below_ = 0;                  ///< beads, and those of them beneath the plate
  double moved_ = 0, by_velocity_ = 0;               ///< sums of squares over all steps, sigma^2
  Eigen::Matrix3d moves_ = Eigen::Matrix3d::Zero(),  ///< sums over all steps: move move^T,
      paths_ = Eigen::Matrix3d::Zero(),              ///< velocity velocity^T, move velocity^T; sigma^2
      both_ = Eigen::Matrix3d::Zero();
  std::size_t jumps_ = 0, jumped_ = 0;  ///< steps that are jumps; the bead of the first one
  std::array<std::int64_t, 2> jump_{};  ///< the frames of the first one
  double jump_length_ = 0;              ///< sigma
  std::size_t exchanges_ = 0;           ///< pairs of frames between which most beads exchange their places
  std::size_t exchanged_ = 0;           ///< beads of the first such pair
  std::array<std::int64_t, 2> exchange_{};  ///< its frames
  std::size_t doubled_ = 0;                 ///< beads at the place of another one
  std::int64_t doubled_step_ = 0;           ///< of the first frame with one
  std::size_t spaced_ = 0, deep_ = 0;       ///< beads, and those of them deep in an earlier one
};

/// What is doubtful in the first `frames` frames of a trajectory, in sentences without a full stop.
/// \throws InputError for a frame that cannot be read
std::vector<std::string> doubts_of(const TrajectorySource& trajectory, std::size_t frames);

}  // namespace twincell
