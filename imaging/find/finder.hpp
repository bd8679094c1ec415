#pragma once
/// \file
/// Circle finders, which propose the centres of circles in a frame, and the list of all finders.
///
/// To add a finder, write a class that satisfies CircleFinder in its own header and .cpp, and add it to the
/// list in finders.cpp. No other file names it.

#include <concepts>
#include <string>
#include <string_view>
#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/preprocess/preprocess.hpp"

namespace twincell::imaging {

/// Options of every finder.
struct FindOptions {
  double radius_px = 0;  ///< bead radius, > 1.5
  /// Share of a full circle's edge that must point at a centre, 0.01 .. 1. Inside a hexagonal packing only
  /// the six small voids face a bead, 5 to 10 % of its edge. False proposals are cheap: the fit and the judge
  /// reject them.
  double min_score = 0.04;
  double apart = 0.8;  ///< smallest distance between two proposals, diameters
};

/// A finder: a type with a name and a function that converts darkness to proposals, best first.
template <class F>
concept CircleFinder = requires(const Prepared& image, const FindOptions& options) {
  { F::name } -> std::convertible_to<std::string_view>;
  { F::find(image, options) } -> std::same_as<std::vector<Proposal>>;
};

/// Allowed values of LocatorOptions::finder; the first is the default.
std::vector<std::string> finder_names();

/// Proposals of the finder with this name, one of finder_names(); empty for any other name. Pure.
std::vector<Proposal> propose(const std::string& finder, const Prepared& image, const FindOptions& options);

}  // namespace twincell::imaging
