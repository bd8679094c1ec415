#pragma once
/// \file
/// Convection: mean displacement of the beads per cycle as a field, its circulation and its rolls.

#include <limits>
#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell::analysis {

/// Displacements averaged in square cells of the plane (x, z), row-major, with row 0 at the bottom. NaN where
/// a cell has too few samples.
struct DisplacementField {
  std::size_t columns = 0, rows = 0;
  double dx = 1, dz = 1;   ///< sigma
  bool periodic = false;   ///< the last column is adjacent to the first
  std::vector<double> ux;  ///< [rows x columns] sigma per cycle
  std::vector<double> uz;  ///< [rows x columns] sigma per cycle
};

/// Circulation of a field, sigma^2 per cycle; counter-clockwise (x right, z up) is positive.
struct Circulation {
  /// [rows - 1 x plaquettes in a row] line integral of u around the loop through the centres of four adjacent
  /// cells, by the trapezoid rule. NaN where a cell is empty. By Stokes' theorem, the sum over a region is
  /// the line integral around it.
  std::vector<double> plaquettes;
  std::size_t columns = 0;  ///< plaquettes in a row
  /// Circulations of the left and right halves. A plaquette on the middle line contributes half to each. NaN
  /// if a half has no plaquette.
  double left = std::numeric_limits<double>::quiet_NaN(), right = left;
};
/// Circulation of every plaquette and of both halves of `field`. Empty if the field has fewer than two rows
/// or columns.
Circulation circulation_of(const DisplacementField& field);

inline constexpr std::size_t kFieldSamples = 5;  ///< minimum number of displacements in a cell
/// Minimum filling of a cell, mean over cycles, as a fraction of close packing. Beads that are thrown about
/// above the bed move by several sigma and would mask the creep of the bed.
inline constexpr double kFieldFilling = 0.75;

/// Displacements of all beads between the beginnings of consecutive cycles, when the plate is at the same
/// height. A displacement is assigned to the cell, of side about AnalysisOptions::field_cell, that contains
/// its midpoint, and is averaged over cycles. Results:
///
/// - displacement_field: [rows x columns x 2] mean displacement (x, z), sigma per cycle
/// - field_x: [columns] x of the centres of the cells, sigma
/// - field_z: [rows] z of the centres of the cells, sigma
/// - circulation_left, circulation_right: scalars, circulation of each half, sigma^2 per cycle; intervals by
///   the jackknife over blocks of cycles
/// - rolls: scalar, number of convection rolls (rolls.hpp)
/// - convection_sense: text, sense of rotation of both halves
///
/// In three dimensions the field is the mean over y. Fortini & Huang 2015, sec. V.
extern const ObservableEntry convection_observable;

}  // namespace twincell::analysis
