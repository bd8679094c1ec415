#pragma once
/// \file
/// Adds the collected results of a sweep to a comparison, as points and phase boundaries.

#include <filesystem>
#include <string>
#include <vector>

#include "analysis/runs/comparison.hpp"

namespace twincell::twin {

/// Reads a file "twincell sweep 1" (JSON) and adds to `comparison` its points with a known phase, and its
/// onsets of bouncing and convecting, at the N_l, Gamma and start that the file states for each
/// ("conditions"). An onset in another measure of the drive (amplitude, peak velocity, K_m) is converted by
/// the Gamma of its points.
/// \returns sentences for the user: points that have no result yet, onsets without a place in the diagram
/// \throws InputError if the file has another format, is damaged, states a phase that its s_b and s_c
/// contradict, or was collected by a version that did not store the conditions, or if none of its points has
/// a place in the diagram
std::vector<std::string> add_sweep(const std::filesystem::path& file, analysis::Comparison& comparison);

/// All of them.
/// \throws as add_sweep, and ConfigError if two hold the same points
std::vector<std::string> add_sweeps(const std::vector<std::filesystem::path>& files,
                                    analysis::Comparison& comparison);

}  // namespace twincell::twin
