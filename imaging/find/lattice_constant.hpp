#pragma once
/// \file
/// Lattice constant of a crystal that fills the frame.

#include <opencv2/core.hpp>

namespace twincell::imaging {

/// Distance of nearest neighbours in a crystal that fills most of a grey frame, px, to 0.75 px from 8 to 25
/// px; 0 if there is no such crystal. For a larger distance the result may be the distance of the gaps.
/// Method: the first maximum of the frame's autocorrelation, averaged over directions, with a prominence
/// close to the largest; then the highest single peak near this distance. Structures broader than 10 px
/// (walls, the bed's shape) are removed first. The maxima of random packings and of isolated discs are not
/// prominent enough. Pure.
double lattice_constant(const cv::Mat& grey);

}  // namespace twincell::imaging
