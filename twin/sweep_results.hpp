#pragma once
/// \file
/// Adds the collected results of a sweep to a comparison, as points and phase boundaries.

#include <filesystem>

#include "analysis/runs/comparison.hpp"

namespace twincell {

/// Reads a file "twincell sweep 1" (JSON) and adds to `comparison` its points with a known phase, and its
/// onsets of bouncing and convecting. N_l, Gamma and start come from the sweep's scene and the axes of each
/// point. \throws InputError if the file has another format, is damaged, or its scene is not found
void add_sweep(const std::filesystem::path& file, Comparison& comparison);

}  // namespace twincell
