#pragma once
/// \file
/// Pairs of highlights, as two lamps make on each bead.

#include <optional>
#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/settings/found_settings.hpp"

namespace twincell::imaging {

/// The pairs, if nearly all discs are the nearest neighbours of each other two by two, in one direction, at
/// one distance, and much closer than to a third one. Beads are never arranged so, but two highlights on each
/// of them are. Empty: they are not. Pure.
std::optional<SpotPairs> spot_pairs(const std::vector<Detection>& discs);

/// Whether most discs are between the two spots of a pair, along the line through them, and not on one of
/// them. Across it they may be off, as the centres of beads that are lit from above. Pure.
bool are_between(const std::vector<Detection>& discs, const SpotPairs& pairs);

}  // namespace twincell::imaging
