#pragma once
/// \file
/// Discs that were left out because they are paler than beads may be.

#include <vector>

#include "imaging/disc/detection.hpp"

namespace twincell::imaging {

/// The candidates of a frame with Verdict::pale that may be discs of another darkness: those with room for a
/// disc, their centres at least 1.5 R from those of beads. Gaps between beads are paler than beads too, but
/// the gap of three in contact is only 1.15 R from their centres. Of candidates that are closer than 1.5 R to
/// each other the first counts: a disc is often proposed twice. R is the radius of the candidate. Pure.
///
/// \returns none if their darkness scatters by more than 12 % (from the median deviation), as of the holes of
///     a perforated table or of clear beads of many levels
std::vector<Detection> paler_discs(const std::vector<Detection>& beads,
                                   const std::vector<Detection>& dropped);

}  // namespace twincell::imaging
