#pragma once
/// \file
/// Numbers that many files name.

#include <limits>
#include <numbers>

namespace twincell {

inline constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();  ///< not measured, not known
inline constexpr double kInfinity = std::numeric_limits<double>::infinity();
inline constexpr double kTurn = 2 * std::numbers::pi;  ///< rad

}  // namespace twincell
