#pragma once
/// \file
/// In-plane bond order of each bead: q6 (Steinhardt), psi6, psi4 and the lattice direction.

#include <vector>

#include "analysis/neighbours/neighbours.hpp"

namespace twincell::analysis {

/// A bead whose psi6 is larger than this is ordered (Fortini & Huang 2015, Fig. 1: "hexagonally ordered").
inline constexpr double kOrdered = 0.9;
/// The directions of a hexagonal lattice repeat after this angle, degrees.
inline constexpr double kLatticePeriodDegrees = 60;
/// The least of these angles; A is 0, B 30.
inline constexpr double kLowestOrientation = -15;

/// Bond order of every bead. NaN where undefined.
struct BondOrder {
  std::vector<double> q6;            ///< [n_beads]
  std::vector<double> psi6;          ///< [n_beads] modulus
  std::vector<double> psi4;          ///< [n_beads] modulus
  std::vector<double> angle;         ///< [n_beads] lattice direction, degrees; see lattice_angle
  std::vector<std::size_t> n_bonds;  ///< [n_beads]
};

/// Bond order of every bead from its bonds in the plane (x, z). With phi the angle of a bond and <.> the mean
/// over the bead's bonds:
///
///     psi_m = |<exp(i m phi)>|
///     q6^2  = sum over |m| <= 6 of (4 pi/13) |Y_6m(pi/2, 0)|^2 |<exp(i m phi)>|^2
///           = (5/16)^2 + 2 (a_2 psi_2^2 + a_4 psi_4^2 + a_6 psi_6^2)
///
/// This is Steinhardt's q_6 with the plane's normal as polar axis (q_6 does not depend on the axis). q6 is
/// 0.74083 in a perfect hexagonal lattice, 0.58630 in a square lattice, and never below 5/16: in a plane, q6
/// does not go to 0 with disorder. NaN for fewer than 2 bonds. The y component of a bond is not used. Fortini
/// & Huang 2015, sec. III, after Steinhardt et al. 1983.
///
/// \param weight weight w of every entry of `neighbours`, for example the length of the shared Voronoi edge
/// (Mickel et al. 2013): <.> = sum w (.)/sum w. Empty: all bonds have the same weight
BondOrder bond_order(const Neighbours& neighbours, const std::vector<double>& weight = {});

/// Lattice direction arg(psi_6)/6 in degrees, from -15 to below 45: the angle between a close-packed row and
/// the floor, modulo 60. The range keeps orientation A (rows along the floor, 0) and B (rows along the side
/// walls, 30; Fortini & Huang 2015, Fig. 2) far from its ends.
double lattice_angle(double real, double imaginary);

/// Smallest rotation between two lattice directions, degrees: 0 to 30.
double misorientation(double angle, double other);

/// Local structure, classified as in the colours of paper 1 but also by the number of bonds: q6 alone does
/// not distinguish a square lattice from disorder.
enum class Structure {
  undefined,  ///< fewer than 2 bonds
  hexagonal,  ///< 6 bonds and |q6 - 0.741| < 0.05
  square,     ///< 4 bonds and |q6 - 0.586| < 0.03
  other,
};
/// Structure of the neighbourhood of a bead.
Structure structure_of(const BondOrder& order, std::size_t bead);

}  // namespace twincell::analysis
