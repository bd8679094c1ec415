#pragma once
/// \file
/// What a way of locating is worth and what it costs: errors against rendered truth beside the Cramér-Rao
/// bound of the same picture, and processor time.

#include <optional>
#include <string>
#include <vector>

#include "core/progress.hpp"

namespace twincell {

/// How beads are located, and in what picture.
struct LocateSetting {
  std::string finder = "vote";   ///< one of finder_names()
  std::string method = "exact";  ///< "exact", "fast" or "edges" (RefineOptions)
  int sweeps = 30;               ///< of the exact fit, at most; 0: the finder's proposals as they are
  double ring_px = 0;            ///< RefineOptions
  double diameter_px = 15;       ///< pixels per bead
  double snr = 51;               ///< of the back-light (rendered/picture.hpp)

  bool operator==(const LocateSetting&) const = default;
};

/// The picture: beads of one size dropped and rolled, touching, on an even back-light, blur 0.8 px. No wall,
/// none cut by the frame.
struct LocateScene {
  int beads = 1600;  ///< per frame
  int width = 40;    ///< of the frame, beads
  int height = 100;  ///< likewise
  int frames = 2;    ///< each with a bed and a noise of its own
};

/// What a setting is worth and what it costs.
struct LocatePrecision {
  LocateSetting setting;
  double recall = 0, precision = 0;
  double rms = 0;                 ///< error per coordinate, px
  double bound = 0;               ///< smallest standard deviation an unbiased estimate can have, px, rms
  double bias_x = 0, bias_y = 0;  ///< mean error, px
  double locking = 0;  ///< first harmonic of the error in the sub-pixel place (rendered/marks.hpp), px
  double locking_by_chance = 0;  ///< what that would be, in the mean, of errors without locking
  double seconds = 0;            ///< processor time of one frame on one thread

  [[nodiscard]] bool complete() const { return recall == 1 && precision == 1; }
  /// Of the bead's diameter.
  [[nodiscard]] double relative() const { return rms / setting.diameter_px; }
};

/// Measures all settings on the same pictures. Settings take turns within a round, so that what else the
/// machine does hits all alike; the fastest of `rounds` counts.
std::vector<LocatePrecision> locate_precision(const std::vector<LocateSetting>& settings,
                                              const LocateScene& scene, int rounds,
                                              Progress& progress = Progress::none());

/// Of the settings at one size and noise that found every bead and invented none, those that no other beats
/// in both rms and time; cheapest first.
std::vector<LocatePrecision> front(const std::vector<LocatePrecision>& all, double diameter_px, double snr);

/// The cheapest of them with an rms error of at most accuracy_px. Absent if there is none.
std::optional<LocatePrecision> cheapest(const std::vector<LocatePrecision>& all, double diameter_px,
                                        double snr, double accuracy_px);

/// What errors of the centres alone leave of s_b (Fortini & Huang 2015, eq. B4, about its mean), in bead
/// diameters: mean heights of `tracers` beads in `phases` phases, each the mean over `cycles`, scatter by
///     s = rms sqrt((1 - 1/phases)/(tracers cycles)).
/// A bed moves if s_b > 1/30; s_b^2 is measured as s_b^2 + s^2. Errors that are the same in every frame
/// cancel. \param relative_rms per coordinate, bead diameters
double bed_displacement_noise(double relative_rms, int tracers, int cycles, int phases);

}  // namespace twincell
