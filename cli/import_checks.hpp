#pragma once
/// \file
/// Looks for signs that an imported file means something else than the options say: beads beneath the plate,
/// velocities or radii that contradict the positions, single beads that jump, beads that are listed twice.

#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <string>
#include <vector>

#include "trajectory/trajectory.hpp"

namespace twincell::cli {

/// Hands frames on to a writer and watches them.
class WatchedImport : public TrajectorySink {
 public:
  /// \param writer, info outlive this object
  WatchedImport(TrajectorySink& writer, const TrajectoryInfo& info) : writer_(writer), info_(info) {}
  void append(const Frame& frame) override;
  /// What is doubtful in the frames so far, in sentences.
  [[nodiscard]] std::vector<std::string> doubts() const;

 private:
  void watch_plate(const Frame& frame);
  void watch_steps(const Frame& frame);
  void watch_doubles(const Frame& frame);
  /// Says that the velocities have another sign or other axes than the moves; empty if they have not.
  [[nodiscard]] std::string turned_velocities() const;

  TrajectorySink& writer_;
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
  std::size_t doubled_ = 0;             ///< beads at the place of another one
  std::int64_t doubled_step_ = 0;       ///< of the first frame with one
};

}  // namespace twincell::cli
