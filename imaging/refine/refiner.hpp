#pragma once
/// \file
/// What fits discs to the picture, from proposed centres to centres with uncertainties, and the list of those
/// that do.
///
/// To add a refiner: its function and a constant of type Refiner in a header of its own, its .cpp, and one
/// word in the list in refiners.cpp.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "imaging/disc/detection.hpp"
#include "imaging/preprocess/preprocess.hpp"
#include "imaging/refine/disc_profile.hpp"

namespace twincell {

/// How the fit is done.
struct RefineOptions {
  std::string method = "exact";  ///< one of refiner_names()
  int sweeps = 30;               ///< at most, 1 .. 1000
  double tolerance_px = 2e-3;    ///< a sweep that moves no bead further is the last, > 0
  double ring_px =
      0;  ///< half width of the ring, 1 .. 50; 0: three times the blur, from 2.5 to 6, or R if that is more
  double blur_px = 0;                  ///< edge blur s; 0: fitted
  double radius_spread = 0.06;         ///< prior: relative scatter of the radii about the given one, > 0
  std::vector<double> other_radii_px;  ///< of discs of further sizes, each likewise
};

/// Result of a refinement.
struct Refined {
  std::vector<Detection> beads;    ///< what may be beads
  std::vector<Detection> dropped;  ///< what turned out to be none, with its verdict
  double blur_px = 0;
  std::array<double, 2> path_px = {};  ///< by which the bed moved during the exposure, either way round
  int sweeps = 0;
  DiscProfile profile;  ///< of DiscModel::shared_profile
};

/// What a refiner takes a disc for.
enum class DiscModel {
  plain,           ///< one darkness inside a blurred rim; discs of several sizes
  circle,          ///< a rim; the inside may be anything, and each disc is fitted by itself
  shared_profile,  ///< one radial profile for all; discs of one size
};

/// A refiner. Pure.
struct Refiner {
  std::string_view word;  ///< RefineOptions::method
  std::string_view help;
  DiscModel model;
  Refined (*fit)(const Prepared& image, const std::vector<Proposal>& proposals, double radius_px,
                 const RefineOptions& options);
};

/// The words of all refiners; the default is the first.
std::vector<std::string> refiner_names();
/// "exact: fit of the picture; fast: ...".
std::string refiners_help();
/// \throws ConfigError naming the option and the words if there is none of that name
const Refiner& refiner_named(const std::string& word);
/// The model of the refiner of that name.
inline DiscModel model_of(const RefineOptions& options) {
  return refiner_named(options.method).model;
}

}  // namespace twincell
