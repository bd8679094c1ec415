#pragma once
/// \file
/// Removal of accepted discs that are not beads: marks of other kinds (tape, walls, letters, water lines)
/// that discs were fitted to.

#include <opencv2/core.hpp>
#include <vector>

#include "imaging/disc/detection.hpp"

namespace twincell::imaging {

/// Whether some scores are so much worse than the others that drop_outliers may find such discs: 1 - score is
/// above 0.01 plus three times its median. In pictures of beads alone none are. Pure.
bool may_have_outliers(const std::vector<Detection>& beads);

/// Drops the discs with such a score without which the evidence of the picture (picture_evidence.hpp) is
/// larger and whose rims fit worse than those of the others: misfit above 1.6. This is done once: a
/// repetition would also drop the neighbours of a bead that was dropped by mistake.
/// \param beads     of one size; those that are not dropped remain
/// \param others    discs that were dropped before; those with their centres outside the frame are visible
/// too
/// \param radius_px the size
/// \returns the dropped ones, with Verdict::unexplained
std::vector<Detection> drop_outliers(const cv::Mat& grey, std::vector<Detection>& beads,
                                     const std::vector<Detection>& others, double radius_px);

}  // namespace twincell::imaging
