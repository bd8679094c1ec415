#pragma once
/// \file
/// What a locator says of a disc in a frame.

#include <cstdint>
#include <string_view>

namespace twincell {

/// A proposed centre.
struct Proposal {
  double x = 0;       ///< px
  double y = 0;       ///< px
  double score = 0;   ///< 0 .. about 1
  double radius = 0;  ///< that it was sought with, px; 0: the only one
};

/// Whether a candidate is a bead, and if not, why.
enum class Verdict : std::uint8_t {
  bead,
  in_wall,        ///< its centre lies in a dark region too large for a bead
  bright_inside,  ///< a void, or a clear bead
  pale,           ///< the fit found hardly a disc there
  unseen,         ///< next to nothing of its edge is in sight
  wrong_radius,   ///< another size than asked for
  unexplained,    ///< a disc does not explain what is seen around its edge
  overlaps,       ///< it overlaps a better explained disc
  outside,        ///< its centre lies outside the frame
};
std::string_view word_of(Verdict verdict);

/// A disc in a frame. Lengths in pixels.
struct Detection {
  double x = 0, y = 0;              ///< centre
  double radius = 0;                ///< R
  double darkness = 0;              ///< a: 1 for an opaque disc, less for a translucent or bright one
  double sigma_x = 0, sigma_y = 0;  ///< one standard deviation of x and y
  double sigma_radius = 0;          ///< likewise of R
  double residual = 0;              ///< rms of the fit on the ring, darkness
  double ring_share = 0;            ///< share of the ring that was free to be fitted, 0 .. 1
  double interior = 0;              ///< median darkness inside R/2
  double score = 0;                 ///< share of the ring's variance that the disc explains, 0 .. 1
  double mass = 0;                  ///< darkness summed over the disc
  double raw_mass = 0;              ///< light taken away by the disc, grey levels: sum of d B
  double signal = 0;                ///< largest darkness in the disc
  double size = 0;                  ///< radius of gyration of the darkness
  double ecc = 0;                   ///< eccentricity of the darkness from its second moments, 0: round
  Verdict verdict = Verdict::bead;
  bool edge = false;         ///< cut by the frame
  bool tracer = false;       ///< interior clearly brighter than that of the other beads
  double tracer_margin = 0;  ///< how far its interior lies from the limit, in scatters of the other beads'
};

}  // namespace twincell
