#pragma once
/// \file
/// Warnings about the scenes of a sweep.

#include <string>
#include <vector>

#include "sweep/schedule.hpp"

namespace twincell::sweep {

/// A warning and the sets of axis values that it concerns.
struct PointWarning {
  std::string text;                 ///< with the numbers of the first point
  std::string kind;                 ///< text without its numbers
  std::vector<std::string> places;  ///< "drive.gamma = 1.2" of the points with this very text
  std::size_t others = 0;           ///< further places, at which the text has other numbers
  std::size_t all = 0;              ///< places of the sweep that are known so far

  /// The warning, and the first three places.
  [[nodiscard]] std::string sentence() const;
};

/// Each kind of warning once, in the order of the points: those of the scenes, and those that the completed
/// runs gave when their beds had settled.
std::vector<PointWarning> warnings_of(const Schedule& schedule);

}  // namespace twincell::sweep
