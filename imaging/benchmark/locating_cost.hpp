#pragma once
/// \file
/// Accuracy and cost of locator settings: errors against rendered truth, the Cramér-Rao bound of the same
/// picture, and processor time.

#include <optional>
#include <string>
#include <vector>

#include "core/progress.hpp"

namespace twincell::imaging {

/// A locator setting and the kind of picture it is applied to.
struct LocateSetting {
  std::string finder = "vote";   ///< one of finder_names()
  std::string method = "exact";  ///< "exact", "fast" or "edges" (RefineOptions)
  int sweeps = 30;               ///< maximum for the exact fit; 0: the unrefined proposals of the finder
  double ring_px = 0;            ///< RefineOptions::ring_px
  double diameter_px = 15;       ///< bead diameter, px
  double snr = 51;               ///< of the back-light (benchmark/picture.hpp)

  bool operator==(const LocateSetting&) const = default;
};

/// The picture: a bed of beads of one size made by drop and roll, in contact, on an even back-light, blur 0.8
/// px. It shows no wall, and the frame cuts no bead.
struct LocateScene {
  int beads = 1600;  ///< per frame
  int width = 40;    ///< of the frame, bead diameters
  int height = 100;  ///< likewise
  int frames = 2;    ///< each has its own bed and its own noise
};

/// Accuracy and cost of one setting.
struct LocatePrecision {
  LocateSetting setting;
  double recall = 0, precision = 0;
  double rms = 0;                 ///< error per coordinate, px
  double bound = 0;               ///< rms of the smallest standard deviation of an unbiased estimate, px
  double bias_x = 0, bias_y = 0;  ///< mean error, px
  double locking = 0;  ///< first harmonic of the error in the sub-pixel position (centre_scores.hpp), px
  double locking_by_chance = 0;  ///< mean value of `locking` for errors without pixel locking, px
  double seconds = 0;            ///< processor time per frame on one thread

  /// Whether every bead is found and every detection is a bead.
  [[nodiscard]] bool complete() const { return recall == 1 && precision == 1; }
  /// The rms error in bead diameters.
  [[nodiscard]] double relative() const { return rms / setting.diameter_px; }
};

/// Measures all settings on the same pictures. Within a round the settings take turns, so that other load on
/// the machine affects all of them equally. The fastest of `rounds` counts.
std::vector<LocatePrecision> locate_precision(const std::vector<LocateSetting>& settings,
                                              const LocateScene& scene, int rounds,
                                              Progress& progress = Progress::none());

/// Pareto front of the settings at one size and noise level: of the settings that find every bead and have no
/// false detections, those that no other setting beats in both rms and time. Fastest first.
std::vector<LocatePrecision> front(const std::vector<LocatePrecision>& all, double diameter_px, double snr);

/// The fastest setting of the front with an rms error of at most accuracy_px; absent if there is no such
/// setting.
std::optional<LocatePrecision> cheapest(const std::vector<LocatePrecision>& all, double diameter_px,
                                        double snr, double accuracy_px);

/// Noise of s_b (Fortini & Huang 2015, eq. B4, about its mean) due to errors of the centres alone, in bead
/// diameters. The mean heights of `tracers` beads in `phases` phases, each averaged over `cycles`, scatter by
///     s = rms sqrt((1 - 1/phases)/(tracers cycles)).
/// A bed moves if s_b > 1/30; the measured s_b^2 is s_b^2 + s^2. Errors equal in every frame cancel.
/// \param relative_rms per coordinate, bead diameters
double bed_displacement_noise(double relative_rms, int tracers, int cycles, int phases);

}  // namespace twincell::imaging
