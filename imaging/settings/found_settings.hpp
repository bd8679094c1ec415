#pragma once
/// \file
/// Locator settings found from a frame.

#include <cstddef>
#include <optional>
#include <string>
#include <vector>

namespace twincell::imaging {

/// The settings found, and how much of the picture they explain.
struct FoundSettings {
  double diameter_px = 0;
  bool bright = false;                     ///< beads are brighter than the background
  double explained = 0;                    ///< sum of -R^2 ln(1 - score), px^2
  std::vector<double> other_diameters_px;  ///< diameters of discs of further sizes
  std::string method;                      ///< new value of RefineOptions::method; empty: unchanged
  double contrast = 1;                     ///< PreprocessOptions::contrast of plain discs
};

/// Settings that were tried on a picture.
struct TriedSettings {
  FoundSettings settings;
  double evidence = 0;    ///< of the picture for the discs located with them, nats (picture_evidence.hpp)
  std::size_t beads = 0;  ///< discs located with them
  double rim_px = 0;      ///< diameter of the rims of these discs; a profile may differ from the searched one
  /// Variation of the rims of these discs (rim_variation.hpp); they are not round above kMaxRimVariation.
  double rim_variation = 0;
  double rim_shift = 0;    ///< of these discs (rim_shift.hpp), in radii; not round above kMaxRimShift
  std::string not_chosen;  ///< why these were not chosen, in words; empty: they have less evidence
  bool preferred = false;  ///< the first candidates, but the chosen ones have enough evidence to replace them
};

/// What discs have in common if they come in pairs.
struct SpotPairs {
  double dx_px = 0, dy_px = 0;  ///< from the left disc of a pair to the right one
  double touching_px = 0;       ///< distance of neighbouring pairs: the width of beads that touch
  struct Middle {
    double x = 0, y = 0;  ///< px
  };
  std::vector<Middle> middles;  ///< of the pairs
};

/// A round region of a picture that is larger than the beads.
struct LargerDisc {
  double x = 0, y = 0;     ///< px
  double diameter_px = 0;  ///< of its rim
  bool bright = false;     ///< brighter than its surroundings
};

/// All settings that were tried, and the best of them.
struct SettingsChoice {
  std::vector<TriedSettings> tried;    ///< the chosen ones first, the others by evidence; empty: no settings
                                       ///< explain the picture
  std::vector<TriedSettings> refused;  ///< if empty: what was tried, with the reasons; those that explain
                                       ///< something but are not round first, each by evidence
  /// The chosen ones explain so much of the picture that other sizes and models were not tried.
  bool suffices = false;
  /// The lattice constant of a crystal that fills the picture, px, if the chosen discs cover little of it:
  /// the beads of the crystal are not among them. 0: none.
  double uncovered_lattice_px = 0;
  /// The smallest distance of two of the chosen discs, px, if the discs may be the highlights of larger beads
  /// that touch at this distance. 0: they may not.
  double apart_px = 0;
  /// The two highlights of each bead, if the discs with most evidence come in pairs (paired_spots.hpp).
  std::optional<SpotPairs> pairs;
  /// The chosen ones are the beads of the pairs, and the second ones their highlights. Otherwise the chosen
  /// ones are the highlights, because no discs with one pair each were found.
  bool beads_of_pairs = false;
  /// Width of the chosen discs, px, if it is that of the highlights of larger beads or of gaps. 0: it is not.
  double spots_px = 0;
  /// The distance of neighbours, px, if it is the width of shaded beads that touch and the chosen discs are
  /// their bright centres. 0: it is not, or another note says so.
  double touching_px = 0;
  /// How much the levels at the rims differ between the lit side and the mean of the discs, in their
  /// contrast, if most discs are lit from the same side. 0: they are not.
  double one_sided = 0;
  /// Round regions that are larger than the beads and that no bead explains (larger_discs.hpp).
  std::vector<LargerDisc> larger;
  /// Share of the pixels that have the brightest grey level of the picture, if the beads are dark. A camera
  /// that its light does not saturate has few of them.
  double saturated = 0;
};

}  // namespace twincell::imaging
