#pragma once
/// \file
/// Which pairs and which bead-wall contacts can touch before the next look (Verlet list with a skin).

#include <cstdint>
#include <vector>

#include "sim/state.hpp"

namespace twincell::sim {

/// A pair that is near enough to touch; i < j. xi is the tangential history, 0 while apart.
struct Pair {
  std::int32_t i, j;
  double m_eff;
  double xi;
};

/// A bead near a wall (index into Walls::of).
struct WallContact {
  std::int32_t bead;
  std::int32_t wall;
  double xi;
};

/// The list and the proof that it is not stale.
///
/// Two beads listed with a gap of at most `skin` between their surfaces cannot have touched unlisted while
/// the sum of the two largest displacements since the build stays below skin. Displacements are measured
/// against a common motion, the mean of all beads, so that a bed riding on the plate stays fresh; for the
/// walls the motion of that mean against the plate is added.
class PairList {
 public:
  /// \param skin sigma; 0.25 adds no pairs in a hexagonal packing (second neighbours sit at 1.73 sigma)
  /// \param periodic_width 0 for side walls
  PairList(double skin, double periodic_width, bool side_walls)
      : skin_(skin), periodic_width_(periodic_width), side_walls_(side_walls) {}

  /// Builds the list anew if it may be stale (or `always`). History is carried over. Returns whether it was
  /// built.
  bool refresh(const System& system, bool always = false);

  std::vector<Pair> pairs;  ///< sorted by (i, j): the order of summation, whenever it was built
  std::vector<WallContact> wall_contacts;  ///< sorted by (bead, wall)
  [[nodiscard]] std::int64_t builds() const { return builds_; }

 private:
  [[nodiscard]] bool stale(const System& system) const;
  void build(const System& system);
  void find_pairs(const System& system, std::vector<Pair>& found) const;

  double skin_, periodic_width_;
  bool side_walls_;
  std::int64_t builds_ = 0;
  std::vector<double> x_, z_;  ///< positions at the build
  double plate_ = 0;           ///< plate height at the build
  double mean_x_ = 0, mean_z_ = 0;
};

}  // namespace twincell::sim
