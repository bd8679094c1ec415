#pragma once
/// \file
/// Which fitted discs are beads.

#include <cstddef>
#include <vector>

#include "imaging/refine.hpp"

namespace twincell {

/// What a bead must show.
struct JudgeOptions {
  double radius_tolerance = 0.2;  ///< relative to the given radius, 0 .. 1
  double min_interior = 0.35;     ///< median darkness inside R/2
  double min_score = 0.5;         ///< Detection::score
  double max_overlap = 0.25;      ///< deepest overlap of two discs, in radii; the lesser is dropped
  double tracer_below = 0.8;      ///< interior below this share of the frame's median: a tracer
};

/// Drops what cannot be an opaque disc (wrong radius, bright inside, unexplained ring, overlap with a better
/// one), and centres outside the frame; flags tracers; orders by y, then x. Pure. \param width, height of the
/// frame, px
std::vector<Detection> judge(std::vector<Detection> beads, double radius_px, int width, int height,
                             const JudgeOptions& options);

}  // namespace twincell
