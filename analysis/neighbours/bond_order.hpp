#pragma once
/// \file
/// Order of the bonds of each bead in the plane: q6 (Steinhardt), psi6, psi4 and the direction of the
/// lattice.

#include <vector>

#include "analysis/neighbours/neighbours.hpp"

namespace twincell {

/// Order of the bonds of one bead. NaN where undefined.
struct BondOrder {
  std::vector<double> q6;            ///< [n_beads]
  std::vector<double> psi6;          ///< [n_beads] modulus
  std::vector<double> psi4;          ///< [n_beads] modulus
  std::vector<double> angle;         ///< [n_beads] direction of the bonds, degrees; see lattice_angle
  std::vector<std::size_t> n_bonds;  ///< [n_beads]
};

/// For bonds in the plane (x, z), with phi their angle and <.> the mean over a bead's bonds:
///
///     psi_m = |<exp(i m phi)>|
///     q6^2  = sum over |m| <= 6 of (4 pi/13) |Y_6m(pi/2, 0)|^2 |<exp(i m phi)>|^2
///           = (5/16)^2 + 2 (a_2 psi_2^2 + a_4 psi_4^2 + a_6 psi_6^2)
///
/// which is Steinhardt's q_6 with the plane's normal as polar axis (it does not depend on the axis). Perfect
/// hexagonal 0.74083, square 0.58630, and never below 5/16: q6 does not go to 0 with disorder in a plane.
/// Undefined (NaN) for fewer than 2 bonds. Fortini & Huang 2015, sec. III, after Steinhardt et al. 1983.
/// The y component of a bond is not used.
/// \param weight  of every entry of `neighbours`, as the lengths of shared Voronoi edges (Mickel et al.
/// 2013):
///                <.> = sum w (.)/sum w. Empty: all bonds count alike
BondOrder bond_order(const Neighbours& neighbours, const std::vector<double>& weight = {});

/// arg(psi_6)/6 in degrees, from -15 to below 45: the angle of a close-packed row to the floor, modulo 60.
/// The range puts orientation A (rows along the floor, 0) and B (rows along the side walls, 30; Fortini &
/// Huang 2015, Fig. 2) far from its ends.
double lattice_angle(double real, double imaginary);

/// Smallest turn that takes one lattice direction into another, degrees: 0 to 30.
double misorientation(double angle, double other);

/// Local structure as paper 1 colours it, but with the number of bonds: q6 alone does not tell a square from
/// disorder.
enum class Structure {
  undefined,  ///< fewer than 2 bonds
  hexagonal,  ///< 6 bonds and |q6 - 0.741| < 0.05
  square,     ///< 4 bonds and |q6 - 0.586| < 0.03
  other,
};
Structure structure_of(const BondOrder& order, std::size_t bead);

}  // namespace twincell
