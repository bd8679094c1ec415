#pragma once
/// \file
/// Distribution of the areas of Voronoi cells.

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

inline constexpr double kVoronoiAreaRange = 3;     ///< largest ratio of an area to the mean of its frame
inline constexpr double kVoronoiAreaWidth = 0.05;  ///< width of a bin

/// Area A of each enclosed Voronoi cell (voronoi.hpp), from its edges of length l at the distance |b|/2 of
/// the bead:
///
///     A = sum over edges of |b| l/4
///
/// sqrt(3)/2 = 0.866 in a close-packed lattice of beads of diameter 1, and the area of the box over the
/// number of beads if all cells are enclosed. In a box that is periodic along x and z the cells are as large
/// as the beads leave them; none is left out unless a frame needs 10^9 bisectors. Elsewhere a bead at a
/// surface has no area, and cells beyond the radius of voronoi.hpp are left out, so that a dilute gas has
/// few, and small ones. The convention of a result states the share of the cells that were left out. Results:
///
/// - voronoi_area: mean, sigma^2; 95 % interval as a correlated series over frames
/// - voronoi_area_variance: variance within a frame, sum (A - <A>)^2/(n - 1), mean over frames, sigma^4; same
/// - voronoi_area_density: [bins] probability density of A over the mean of its frame, up to 3 in bins of
/// 0.05
/// - voronoi_area_density_low, voronoi_area_density_high: [bins] ends of its 95 % interval
/// - voronoi_area_ratio: [bins] centres of the bins
///
/// Planar beds only. F. W. Starr et al., Phys. Rev. Lett. 89 (2002) 125501.
extern const ObservableEntry voronoi_area_observable;

}  // namespace twincell::analysis
