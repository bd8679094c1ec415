#pragma once
/// \file
/// Results of the windows of a run whose drive changes, against the drive: the loop of a hysteresis.

#include <string>
#include <vector>

#include "analysis/report/figure.hpp"
#include "analysis/runs/windows.hpp"

namespace twincell::analysis {

/// The numbers whose figures are drawn if no result is requested by name.
inline constexpr const char* kWindowNumbers[] = {"s_b", "s_c", "q6"};

/// One figure for each result that is one number, with its interval, against Gamma in the middle of each
/// window; against omega if Gamma is constant, against the first cycle if both are. Windows in which this
/// number rises are filled, those in which it falls are open.
/// \param only names of results; empty: kWindowNumbers
std::vector<Figure> windows_figures(const std::vector<Window>& windows, const std::vector<std::string>& only);

}  // namespace twincell::analysis
