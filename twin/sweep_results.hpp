#pragma once
/// \file
/// The collected results of a sweep, as points and boundaries of a comparison.

#include <filesystem>

#include "analysis/runs/comparison.hpp"

namespace twincell {

/// Reads a file "twincell sweep 1" (JSON) and adds its points with a phase, and its onsets of bouncing and
/// convecting, to `comparison`. N_l, Gamma and start of each are those of the sweep's scene with the point's
/// axes. \throws InputError if it is no such file or does not say what its scene is
void add_sweep(const std::filesystem::path& file, Comparison& comparison);

}  // namespace twincell
