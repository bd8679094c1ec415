#pragma once
/// \file
/// What proposes the centres of circles in a frame, and the list of those that do.
///
/// To add a finder: a class that satisfies CircleFinder in a header of its own, its .cpp, and one word in the
/// list in finders.cpp. Nothing else names it.

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/preprocess/preprocess.hpp"

namespace twincell {

/// What every finder is told.
struct FindOptions {
  double radius_px = 0;  ///< bead radius, > 1.5
  /// Share of a full circle's edge that must point at a centre, 0 .. 1. Inside a hexagonal packing only the
  /// six small voids face a bead, 5 to 10 % of its edge; false proposals are cheap, the fit and the judge
  /// drop them.
  double min_score = 0.04;
  double apart = 0.8;  ///< no two proposals are nearer to each other, diameters
};

/// A finder: a type with a name that turns darkness into proposals, best first.
template <class F>
concept CircleFinder = requires(const Prepared& image, const FindOptions& options) {
  { F::name } -> std::convertible_to<std::string_view>;
  { F::find(image, options) } -> std::same_as<std::vector<Proposal>>;
};

/// Names that LocatorOptions::finder may take; the default is the first.
std::vector<std::string> finder_names();

/// What the finder of that name, one of finder_names(), proposes; none by another name. Pure.
std::vector<Proposal> propose(const std::string& finder, const Prepared& image, const FindOptions& options);

}  // namespace twincell
