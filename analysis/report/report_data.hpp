#pragma once
/// \file
/// Data of the interactive page, as JSON.

#include <string>

#include "analysis/runs/comparison.hpp"

namespace twincell::analysis {

/// Text of one JSON object, safe inside a script element, with these members:
///
/// - runs: side, name, start, gamma, k_m, omega, n_l, phase, beads, box [x0, x1, z0, z1] (sigma), periodic,
///   radius [1/1000 sigma] or null, tracers (slots), camera {s, ox, oy, w, h} (px) or null, results (as
///   results_json, without per-bead results), convection {rows, columns, extent [x0, x1, z0, z1], u, w} or
///   null, moments
/// - moments (of a run): label, step, cycle, fraction (of a period), plate; x, z [1/1000 sigma], q6, psi6
///   [1/100, -1: undefined], bonds, coordination (0: surface) and structure for each slot, with x and z null
///   in an empty slot; picture (data URI) or null
/// - matches, boundaries, sweep: as in Comparison
std::string report_data(const Comparison& comparison);

}  // namespace twincell::analysis
