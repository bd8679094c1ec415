#pragma once
/// \file
/// Identities through the frames.
///
/// First the motion common to all beads is removed: the shift that brings most beads onto their old places (a
/// histogram of all pair shifts, so that a crystal moved by up to about a diameter is told from its
/// neighbours by its rim). Then tracks and detections are assigned so that the sum of squared distances from
/// the predicted places is least, a track without detection or a detection without track costing range^2 / 2
/// each. Since discs cannot overlap, a detection within 0.3 d of a prediction has no rival there; the rest
/// falls into small groups that are solved exactly.

#include <cstdint>
#include <vector>

#include "imaging/pixel_frame.hpp"

namespace twincell {

/// How identities are kept.
struct LinkOptions {
  double diameter_px = 0;      ///< bead diameter, > 0
  double range_diameters = 1;  ///< longest step from the predicted place, diameters
  int memory = 3;  ///< frames for which a bead may be missing, >= 0; the range grows by half per frame
  double max_shift_diameters = 1.5;  ///< largest common motion per frame sought, diameters, >= 0; 0: none
};

/// Links frame after frame; memory is one entry per living track.
class Linker {
 public:
  /// \throws ConfigError if an option is out of range
  explicit Linker(const LinkOptions& options);
  /// Gives each detection of the next frame its track: old numbers go on, new ones are counted from 0.
  std::vector<std::int64_t> next(const std::vector<PixelPoint>& detections);
  /// Tracks so far.
  [[nodiscard]] std::int64_t n_tracks() const { return n_tracks_; }
  /// Common motion found in the last step, px.
  [[nodiscard]] PixelPoint common_shift() const { return shift_; }

 private:
  struct Track {
    std::int64_t id;
    PixelPoint place;     // last seen, moved along with the common motion since
    PixelPoint own_step;  // last step less the common motion
    int missed;
  };
  LinkOptions options_;
  std::vector<Track> tracks_;
  std::int64_t n_tracks_ = 0;
  PixelPoint shift_;
};

/// Minimum-cost assignment (Kuhn-Munkres by shortest augmenting paths, O(n^2 m)).
/// \param cost n x m, n <= m, row by row; finite
/// \returns the column of each row
std::vector<std::size_t> assign(const std::vector<double>& cost, std::size_t n, std::size_t m);

}  // namespace twincell
