#pragma once
/// \file
/// Costs of missing and doubled frames in the most likely path of phases, in natural log-odds.

namespace twincell::imaging {

inline constexpr double kSlipCost = 12;        ///< of a dropped or doubled frame
inline constexpr double kFurtherDropCost = 2;  ///< of each further frame dropped there
inline constexpr double kMaxFrameCost = 9;     ///< of one frame's deviation: one bad height makes no slip
inline constexpr double kMinScatter = 0.02;    ///< fraction of A: a shaker does not follow a sine exactly

}  // namespace twincell::imaging
