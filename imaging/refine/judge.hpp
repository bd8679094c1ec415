#pragma once
/// \file
/// Which fitted discs are beads.

#include <vector>

#include "imaging/disc/detection.hpp"

namespace twincell {

/// What a bead must show.
struct JudgeOptions {
  double radius_tolerance = 0.2;       ///< relative to the given radius, 0 .. 1
  std::vector<double> other_radii_px;  ///< further sizes of beads
  double min_interior = 0.35;          ///< median darkness inside R/2
  double min_score = 0.5;              ///< Detection::score
  double max_overlap = 0.25;           ///< deepest overlap of two discs, in radii; the lesser is dropped
  double tracer_below = 0.8;           ///< interior below this share of the frame's median: a tracer
};

/// What became of the candidates.
struct Judged {
  std::vector<Detection> beads;
  std::vector<Detection> dropped;  ///< each with its verdict
};

/// Drops what cannot be an opaque disc (wrong radius, bright inside, unexplained ring, overlap with a better
/// one), and centres outside the frame; flags tracers, and discs that the frame cuts. Pure.
/// \param width, height of the frame, px
Judged judge(std::vector<Detection> candidates, double radius_px, int width, int height,
             const JudgeOptions& options);

}  // namespace twincell
