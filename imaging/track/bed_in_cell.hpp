#pragma once
/// \file
/// Whether the tracked beads fill the cell that is stated: a bed of several layers touches both side walls,
/// crosses sides that are periodic, and rests on the plate in a part of each cycle.

#include <cstddef>
#include <string>
#include <vector>

#include "imaging/cell/cell.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::imaging {

/// Hands frames on to a writer and notes how close the beads come to the side walls and to the plate.
class BedInCell : public TrajectorySink {
 public:
  /// \param writer, info outlive this object
  /// \param width_px, height_px of the picture: a plate below it is not checked, nor a wall beside it if the
  /// picture cuts the bed
  BedInCell(TrajectorySink& writer, const TrajectoryInfo& info, const CellDescription& cell, int width_px,
            int height_px);
  void append(const Frame& frame) override;
  /// Observations that contradict the stated cell, as sentences: over the frames, the median gap at a side
  /// wall, and the gap at the plate that 5 % of the frames fall below, each if it exceeds 0.35 bead diameters
  /// to either side. Walls are checked for beds of two layers and more over their own width. Periodic sides
  /// that beds of four layers and more do not cross, as if there were walls.
  [[nodiscard]] std::vector<std::string> doubts() const;
  /// The first of these in a bed of two layers and more with a gap above one bead diameter, which no bed has;
  /// empty if there is none.
  [[nodiscard]] std::string contradiction() const;

 private:
  struct Finding {
    std::string sentence;
    double gap;  ///< bead diameters
  };
  [[nodiscard]] bool is_layered() const;
  /// Whether the beads stop at periodic sides.
  [[nodiscard]] bool stops_at_periods() const;
  [[nodiscard]] std::vector<Finding> findings() const;

  TrajectorySink& writer_;
  const TrajectoryInfo& info_;
  double width_ = 0;                                  ///< between the walls, sigma; 0: not checked
  double period_ = 0;                                 ///< of the sides, sigma; 0: not checked
  double picture_left_ = 0, picture_right_ = 0;       ///< its borders from the left wall, sigma
  bool plate_ = false;                                ///< checked
  std::vector<double> left_, right_, below_, beads_;  ///< by frame: gaps, sigma, and the number of beads
};

}  // namespace twincell::imaging
