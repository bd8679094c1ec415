#pragma once
/// \file
/// The sizes and polarities of discs that a picture suggests, by the votes of its gradients for the centres
/// of circles (vote_finder.hpp).

#include <opencv2/core.hpp>
#include <optional>
#include <vector>

#include "imaging/locate/locator.hpp"
#include "imaging/preprocess/preprocess.hpp"
#include "imaging/settings/hypothesis_test.hpp"

namespace twincell::imaging {

/// Bead diameter (px) at which the gradient votes of a frame are sharpest, searched from 6 to 80 px. Accurate
/// to a few per cent for beads of one size. Returns 0 if no round object stands out.
double estimate_diameter(const cv::Mat& grey, const PreprocessOptions& options);

/// A range of the contrast of discs.
struct Contrasts {
  double least, below;
};

/// Sizes proposed by the votes of one or both polarities, and the lattice constant; the given size if one is
/// given.
///
/// \param lattice lattice constant, px; 0: no crystal
/// \param of if given, instead those of discs of the contrast of the picture, if this is in the range: the
///     gradients of pale discs are too weak to vote
std::vector<Hypothesis> size_hypotheses(const cv::Mat& grey, const LocatorOptions& given, double lattice,
                                        const std::optional<Contrasts>& of = {});

}  // namespace twincell::imaging
