#pragma once
/// \file
/// Acceptance test: which fitted discs are beads.

#include <vector>

#include "imaging/disc/detection.hpp"

namespace twincell::imaging {

/// Largest difference of a bead's radius from a given one, relative to it.
inline constexpr double kRadiusTolerance = 0.2;

/// Acceptance criteria for a bead.
struct JudgeOptions {
  std::vector<double> other_radii_px;          ///< further sizes of beads
  double radius_tolerance = kRadiusTolerance;  ///< larger if the beads have a broad distribution of sizes
  double min_interior = 0.35;                  ///< median darkness inside R/2
  double min_score = 0.5;                      ///< smallest Detection::score, 0 .. 1
  bool pale = false;          ///< a pale disc (RefineOptions) is as pale inside as at its rim
  double max_overlap = 0.25;  ///< largest overlap of two discs, in radii; beyond it the worse is dropped
  double tracer_below = 0.8;  ///< a tracer's interior is below this fraction of the median; 0: no tracers
  /// The same if five tracers or more, which are alike, are scattered among three times as many other beads.
  double close_tracer_below = 0.95;
  /// Discs that are not beads are dropped (outlier_discs.hpp). For one size that the picture gave: beads of a
  /// stated size are beads, and beads of many sizes are too unlike each other.
  bool drop_outliers = false;
};

/// The candidates, sorted into beads and rejected discs.
struct Judged {
  std::vector<Detection> beads;
  std::vector<Detection> dropped;  ///< each with its verdict
};

/// Rejects candidates that cannot be an opaque disc (wrong radius, bright inside, unexplained ring, overlap
/// with a better one) and centres outside the frame. Flags discs that are cut by the frame, and tracers:
/// beads with interiors below tracer_below of the median, or, if there are none, above median/tracer_below,
/// if a gap separates them from the rest that one population with a log-concave distribution shows in at most
/// one of a thousand frames. If all beads have one size, the limit is close_tracer_below for tracers that are
/// alike and scattered among the others. Pure.
/// \param width, height of the frame, px
Judged judge(std::vector<Detection> candidates, double radius_px, int width, int height,
             const JudgeOptions& options);

}  // namespace twincell::imaging
