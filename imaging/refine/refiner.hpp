#pragma once
/// \file
/// Refiners: they fit discs to the picture, from proposed centres to centres with uncertainties. Also the
/// list of all refiners.
///
/// To add a refiner, write its function and a constant of type Refiner in a header of its own, its .cpp, and
/// one entry in the list in refiners.cpp.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/preprocess/preprocess.hpp"
#include "imaging/refine/disc_profile.hpp"

namespace twincell::imaging {

/// A fit stops when no bead moves farther in a sweep, px.
inline constexpr double kRefineTolerance_px = 2e-3;
/// Prior: relative scatter of the radii about the given ones.
inline constexpr double kRadiusSpread = 0.06;

/// Options of the fit.
struct RefineOptions {
  std::string method = "exact";  ///< one of refiner_names()
  int sweeps = 30;               ///< largest number of sweeps, 1 .. 100
  /// Half width of the ring, 1 .. 50; 0: three times the blur, at least 2.5, at most max(6, R).
  double ring_px = 0;
  double blur_px = 0;                  ///< edge blur s, 0 .. 10; 0: fitted
  std::vector<double> other_radii_px;  ///< radii of discs of further sizes, with the same scatter
  /// Keep discs of less than 0.4 of the usual darkness that are otherwise as the others are.
  bool pale = false;
};

/// Result of a refinement.
struct Refined {
  std::vector<Detection> beads;    ///< candidates for beads
  std::vector<Detection> dropped;  ///< rejected candidates, each with its verdict
  double blur_px = 0;
  std::array<double, 2> path_px = {};  ///< path of the bed during the exposure; its sign is arbitrary
  int sweeps = 0;
  DiscProfile profile;  ///< set by DiscModel::shared_profile
};

/// The model of a disc that a refiner uses.
enum class DiscModel {
  plain,           ///< uniform darkness inside a blurred rim; discs of several sizes
  circle,          ///< a rim with an arbitrary inside; each disc is fitted separately
  shared_profile,  ///< one radial profile for all discs; discs of one size
};

/// A refiner. Pure.
struct Refiner {
  std::string_view word;  ///< RefineOptions::method
  std::string_view help;
  DiscModel model;
  Refined (*fit)(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                 const RefineOptions& options);
  bool layers = false;  ///< for beads in two layers, whose discs overlap in projection
};

/// The names of all refiners; the first is the default.
std::vector<std::string> refiner_names();
/// Help text: "exact: ...; fast: ...".
std::string refiners_help();
/// \throws ConfigError naming the option and the known names if no refiner has that name
const Refiner& refiner_named(const std::string& word);
/// The model of the refiner that the options name.
inline DiscModel model_of(const RefineOptions& options) {
  return refiner_named(options.method).model;
}

}  // namespace twincell::imaging
