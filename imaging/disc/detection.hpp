#pragma once
/// \file
/// Proposals and detections of discs in a frame.

#include <array>
#include <cstdint>
#include <string_view>

#include "core/choice.hpp"

namespace twincell::imaging {

/// A proposed disc centre.
struct Proposal {
  double x = 0;       ///< px
  double y = 0;       ///< px
  double score = 0;   ///< 0 .. about 1
  double radius = 0;  ///< radius used to find it, px; 0: the only radius in use
};

/// Whether a candidate is a bead, and if not, the reason.
enum class Verdict : std::uint8_t {
  bead,
  in_wall,
  bright_inside,
  pale,
  unseen,
  wrong_radius,
  unexplained,
  overlaps,
  outside
};
/// All verdicts with their words.
inline constexpr std::array kVerdicts = {
    Choice<Verdict>{Verdict::bead, "bead", "a bead"},
    Choice<Verdict>{Verdict::in_wall, "in a wall", "its centre is in a dark region too large for a bead"},
    Choice<Verdict>{Verdict::bright_inside, "bright inside", "a void, or a transparent bead"},
    Choice<Verdict>{Verdict::pale, "pale", "the fitted darkness is too small"},
    Choice<Verdict>{Verdict::unseen, "unseen", "almost none of its edge is visible"},
    Choice<Verdict>{Verdict::wrong_radius, "wrong radius", "its size is not one of the requested sizes"},
    Choice<Verdict>{Verdict::unexplained, "unexplained",
                    "a disc does not explain the picture around its edge"},
    Choice<Verdict>{Verdict::overlaps, "overlaps", "it overlaps a disc that explains the picture better"},
    Choice<Verdict>{Verdict::outside, "outside", "its centre is outside the frame"}};
/// The verdict in words, for output.
std::string_view word_of(Verdict verdict);

/// A detected disc in a frame. Lengths in pixels.
struct Detection {
  double x = 0, y = 0;              ///< centre
  double radius = 0;                ///< R
  double darkness = 0;              ///< a: 1 for an opaque disc, less for a translucent or bright one
  double sigma_x = 0, sigma_y = 0;  ///< one standard deviation of x and y
  double sigma_radius = 0;          ///< one standard deviation of R
  double residual = 0;              ///< rms of the fit on the ring, darkness
  double ring_share = 0;            ///< share of the ring's pixels used by the fit, 0 .. 1
  double interior = 0;              ///< median darkness inside R/2
  double score = 0;                 ///< share of the ring's variance that the disc explains, 0 .. 1
  double mass = 0;                  ///< darkness summed over the disc
  double raw_mass = 0;              ///< light blocked by the disc, grey levels: sum of d B
  double signal = 0;                ///< largest darkness in the disc
  double size = 0;                  ///< radius of gyration of the darkness
  double ecc = 0;                   ///< eccentricity of the darkness from its second moments, 0: round
  Verdict verdict = Verdict::bead;
  bool edge = false;         ///< cut by the frame
  bool overlap = false;      ///< overlaps another bead in projection
  bool tracer = false;       ///< interior clearly brighter than that of the other beads
  double tracer_margin = 0;  ///< distance of its interior from the limit, in scatters of the other beads
};

}  // namespace twincell::imaging
