#pragma once
/// \file
/// Costs of missing and doubled frames in the most likely path of phases, in natural log-odds.

namespace twincell::imaging {

inline constexpr double kSlipCost = 12;        ///< of a dropped or doubled frame
inline constexpr double kFurtherDropCost = 2;  ///< of each further frame dropped there

}  // namespace twincell::imaging
