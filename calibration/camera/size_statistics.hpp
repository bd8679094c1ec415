#pragma once
/// \file
/// Statistics of the beads of a cell: number, diameter, polydispersity, and centre distance of touching
/// beads.

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "imaging/geometry/lens.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/refine/rim_aspect.hpp"
#include "imaging/stack/frame_source.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::calibration {

/// One measured bead; lengths in pixels of the ideal picture (or in sigma, from a trajectory).
struct SizedBead {
  double x = 0, y = 0;
  double radius = 0;
  double sigma_radius = 0;  ///< 0: unknown
};
/// Beads of some frames. Beads that the frame's border cuts are counted, but their sizes are left out.
struct BeadFrames {
  std::vector<std::vector<SizedBead>> frames;  ///< [frames][beads]
  std::vector<std::size_t> counts;             ///< [frames], beads cut by the border included
  /// [frames] objects of another size, which do not count as beads. One or two discs a frame of a larger size
  /// that the settings found, such as an intruder, have their radius; that of rejected discs is 0. Rejected
  /// discs within a bead diameter of their mean position are one object.
  std::vector<std::vector<SizedBead>> others;
  /// Systematic errors of the diameters beyond their noise: of the mean, and from disc to disc, which depends
  /// on the contacts of each disc. 0: no systematic error.
  double mean_model_error = 0, model_scatter = 0;
  std::optional<imaging::Aspect> aspect;  ///< of the discs in the picture, from their first dozen frames
};

/// Systematic errors of the diameters from locate_beads, px. Touching discs are measured too large by the
/// first number (end_to_end.Calibrate.AccuracyCostsFrames). The second is the standard deviation between
/// discs of equal size, which is due to their neighbours.
inline constexpr double kDiameterModelError_px = 0.002, kDiameterModelScatter_px = 0.012;
/// Locates the beads in up to `most` frames, spread over the stack. Options that are not set are chosen from
/// the first frames (configure_locator.hpp).
/// \param lens if given, its distortion is removed from positions and radii
BeadFrames locate_beads(imaging::FrameSource& frames, const imaging::LocatorOptions& options,
                        const std::optional<imaging::Lens>& lens, int most, int threads,
                        Progress& progress = Progress::none());
/// The same from up to `most` frames of a trajectory, in sigma, with the trajectory's own radii.
/// \throws InputError if it has no radii
BeadFrames beads_of(const TrajectorySource& trajectory, int most);

/// A number and its standard error.
struct Estimate {
  double value = 0, error = 0;
};

/// Statistics of number, size and spacing of the beads.
struct SizeStatistics {
  std::size_t frames = 0, sizes = 0;
  Estimate count;     ///< beads in a frame: median, error of the median from the scatter between frames
  Estimate diameter;  ///< mean; in the unit of the frames
  Estimate spread;    ///< standard deviation of the diameters over their mean, measurement noise subtracted
  Estimate mass;      ///< mean of (d/<d>)^3: mean mass over the mass of a bead of mean diameter
  /// Relative change of the diameters per length unit along x and y: a camera that is not perpendicular to
  /// the cell images distant beads smaller. The errors assume that beads are not sorted by size.
  Estimate gradient_x, gradient_y;
  std::vector<double> diameters;    ///< accepted diameters of all frames, sorted, for the histogram
  std::optional<Estimate> spacing;  ///< centre distance of touching beads; absent if it cannot be determined
};

/// A sentence, without a full stop, if at least half of the frames show objects of another size than the
/// beads, such as an intruder, and these are at most a tenth of the beads. Empty otherwise.
std::string others_in_words(const BeadFrames& beads);

/// Computes the statistics. Beads of one frame count as independent, the same beads in other frames do not:
/// the standard errors of quantities that vary between beads use the number of beads in one frame.
/// \throws InputError for fewer than 3 beads
SizeStatistics count_beads(const BeadFrames& beads);

}  // namespace twincell::calibration
