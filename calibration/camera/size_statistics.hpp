#pragma once
/// \file
/// The beads of a cell: how large, how unlike, how many, how far apart when they touch.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "imaging/geometry/lens.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/stack/frame_source.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell {

/// One measured bead; lengths in pixels of the ideal picture (or in sigma, from a trajectory).
struct SizedBead {
  double x = 0, y = 0;
  double radius = 0;
  double sigma_radius = 0;  ///< 0: unknown
};
/// [frames][beads]. Beads cut by the frame's border are left out of the sizes but counted.
struct BeadFrames {
  std::vector<std::vector<SizedBead>> frames;
  std::vector<std::size_t> counts;  ///< [frames], cut ones included
  /// What a disc's diameter may be off by beyond its noise: the mean of all, and from disc to disc, by who
  /// touches whom. 0: by nothing.
  double mean_model_error = 0, model_scatter = 0;
};

/// Of diameters as locate_beads finds them, px: touching discs come out so much too large
/// (end_to_end.Calibrate.AccuracyCostsFrames), and discs of one size scatter so much with their neighbours.
inline constexpr double kDiameterModelError_px = 0.002, kDiameterModelScatter_px = 0.012;
/// Locates up to `most` frames of a stack, spread over it. What the options leave open is found from the
/// first frames (configure_locator.hpp). \param lens undone where given
BeadFrames locate_beads(FrameSource& frames, const LocatorOptions& options, const std::optional<Lens>& lens,
                        int most, int threads, Progress& progress = Progress::none());
/// The same of a trajectory, in sigma, radii as it has them. \throws InputError if it has none
BeadFrames beads_of(const TrajectorySource& trajectory, int most);

/// A number and its standard error.
struct Estimate {
  double value = 0, error = 0;
};

/// What the beads say.
struct SizeStatistics {
  std::size_t frames = 0, sizes = 0;
  Estimate count;     ///< beads in a frame: median, error of the median from the scatter between frames
  Estimate diameter;  ///< mean; in the unit of the frames
  Estimate spread;    ///< standard deviation of the diameters over their mean, the fit's own error taken off
  Estimate mass;      ///< mean of (d/<d>)^3: the mean mass over that of a bead of mean size
  /// Relative change of the diameters along x and y, 1 over the frames' unit: a camera that looks askew sees
  /// far beads smaller. Errors as if beads did not sort themselves by size.
  Estimate gradient_x, gradient_y;
  std::vector<double> diameters;    ///< all of one frame's worth, for the picture, sorted
  std::optional<Estimate> spacing;  ///< distance of touching beads; absent where none show
};

/// \throws InputError for fewer than 3 beads. Beads of one frame count as independent, the same beads in
/// other frames do not: standard errors of what differs between beads go with the beads of a frame.
SizeStatistics count_beads(const BeadFrames& beads);

}  // namespace twincell
