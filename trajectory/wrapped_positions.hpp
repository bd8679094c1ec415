#pragma once
/// \file
/// Positions that a file wraps into the period of its box without the number of periods that a bead has
/// crossed, and how they go on across the period.
///
/// Along an axis of period L, positions count as wrapped if their extent over all beads and frames is at most
/// L + 2 sigma. The extent counts rather than the box: some programs have the middle of their box at the
/// origin, and some let a bead leave the period for a few steps. A wrapped bead then moves by the shorter way
/// from the frame in which it was seen last:
///
///     unwrapped r_n = r_n + m_n L,   m_n = m_k - round((r_n - r_k)/L),   m = 0 where it is seen first
///
/// with r_k its position in that frame. A bead that moves by more than L/2 in between cannot be followed.

#include <cmath>
#include <cstddef>
#include <vector>

#include "trajectory/box.hpp"

namespace twincell {

/// Decides along which axes the positions of a file are wrapped.
class PositionExtent {
 public:
  /// A bead of any frame. Coordinates that are not finite are left out.
  void add(const Vec3& position);
  /// Whether the positions added so far count as wrapped along `axis`. Positions that were never wrapped and
  /// do not leave the period count too; unwrapping does not change them.
  /// \param period L; not above 0: the axis is not periodic, and nothing is wrapped
  /// \param sigma bead diameter in the unit of the positions
  [[nodiscard]] bool is_wrapped(int axis, double period, double sigma = 1) const;

 private:
  Vec3 least_ = Vec3::Constant(HUGE_VAL), most_ = Vec3::Constant(-HUGE_VAL);
};

/// Counts the periods that each bead has crossed, frame after frame.
class PeriodCounter {
 public:
  /// \param period L of each axis; not above 0 along an axis whose positions are not wrapped
  PeriodCounter(const Vec3& period, std::size_t n_beads);
  /// m of a bead in the next frame, whole numbers. A coordinate that is not finite leaves its count as it
  /// was.
  const Vec3& next(std::size_t bead, const Vec3& position);
  /// As next().
  /// \returns the position r + m L
  Vec3 unwrapped(std::size_t bead, const Vec3& position);
  /// r + m L, where m is not 0; other coordinates stay as they are to the bit.
  static Vec3 moved(Vec3 r, const Vec3& m, const Vec3& period);

 private:
  Vec3 period_;
  std::vector<Vec3> last_;  ///< NaN until a bead is seen
  std::vector<Vec3> counts_;
};

}  // namespace twincell
