#pragma once
/// \file
/// Bond order in the plane: q6 (Steinhardt), psi6, psi4.

#include <memory>
#include <vector>

#include "analysis/neighbours.hpp"
#include "analysis/observable.hpp"

namespace twincell {

/// Order of the bonds of one bead. NaN where undefined.
struct BondOrder {
  std::vector<double> q6;            ///< [n_beads]
  std::vector<double> psi6;          ///< [n_beads] modulus
  std::vector<double> psi4;          ///< [n_beads] modulus
  std::vector<std::size_t> n_bonds;  ///< [n_beads]
};

/// For bonds in the plane (x, z), with phi their angle and <.> the mean over a bead's n bonds:
///
///     psi_m = |<exp(i m phi)>|
///     q6^2  = sum over |m| <= 6 of (4 pi/13) |Y_6m(pi/2, 0)|^2 |<exp(i m phi)>|^2
///           = (5/16)^2 + 2 (a_2 psi_2^2 + a_4 psi_4^2 + a_6 psi_6^2)
///
/// which is Steinhardt's q_6 with the plane's normal as polar axis (it does not depend on the axis). Perfect
/// hexagonal 0.74083, square 0.58630, and never below 5/16: q6 does not go to 0 with disorder in a plane.
/// Undefined (NaN) for fewer than 2 bonds. Fortini & Huang 2015, sec. III, after Steinhardt et al. 1983.
/// The y component of a bond is not used.
BondOrder bond_order(const Neighbours& neighbours);

/// Local structure as paper 1 colours it, but with the number of bonds: q6 alone does not tell a square from
/// disorder.
enum class Structure {
  undefined,  ///< fewer than 2 bonds
  hexagonal,  ///< 6 bonds and |q6 - 0.741| < 0.05
  square,     ///< 4 bonds and |q6 - 0.586| < 0.03
  other,
};
Structure structure_of(const BondOrder& order, std::size_t bead);

/// Results q6, psi6, psi4 (means over beads and frames), hexagonal_fraction, square_fraction, and q6_beads,
/// psi6_beads, psi4_beads of the last frame.
std::unique_ptr<Observable> make_bond_order(const AnalysisContext& context);

}  // namespace twincell
