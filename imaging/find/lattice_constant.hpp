#pragma once
/// \file
/// The period of a crystal that fills the frame.

#include <opencv2/core.hpp>

namespace twincell {

/// Distance of nearest neighbours in a crystal that fills most of a grey frame, px, to 0.75 px from 8 to 25
/// px; 0 if there is no such crystal. Of one with a wider period it may be the distance of the gaps. The
/// first maximum of the frame's autocorrelation, averaged over directions, that stands out from the minima
/// beside it nearly as much as any other; then the highest of the spots it is made of. What is broader than
/// 10 px (walls, the bed's shape) is left out. Random packings and discs apart do not stand out enough. Pure.
double lattice_constant(const cv::Mat& grey);

}  // namespace twincell
