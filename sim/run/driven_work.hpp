#pragma once
/// \file
/// Work of a driven bed relative to the same bed at rest, for forecasts of the run time.

namespace twincell::sim {

/// Processor time of a step of a driven bed, averaged over a period, divided by that of the same bed at rest.
/// An airborne bed has fewer contacts, so the ratio falls with Gamma; a deep bed dilates slowly, so it rises
/// with the number of layers.
///
/// Interpolated linearly in Gamma and in the logarithm of the layers between measured ratios: the first
/// paper's beads in a cell 20 sigma wide, 10 to 160 layers, Gamma = 1 to 5, four periods each. Outside this
/// range the nearest value applies. The measured points are returned exactly.
/// \param gamma peak acceleration of the plate over gravity, at least 0
/// \param layers beads per diameter of width (3D: per square diameter of area), above 0
/// \returns a number in (0, 1]
double driven_work(double gamma, double layers);

}  // namespace twincell::sim
