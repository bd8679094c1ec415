#pragma once
/// \file
/// The convection field: how far beads move in one cycle, where, and in which sense they go round.

#include <limits>
#include <memory>
#include <vector>

#include "analysis/observable/observable.hpp"

namespace twincell {

/// Displacements averaged in square cells of the plane (x, z); row-major, row 0 the lowest. NaN where a cell
/// has too few samples.
struct DisplacementField {
  std::size_t columns = 0, rows = 0;
  double dx = 1, dz = 1;   ///< sigma
  bool periodic = false;   ///< the last column is the first one's neighbour
  std::vector<double> ux;  ///< [rows x columns] sigma per cycle
  std::vector<double> uz;  ///< [rows x columns] sigma per cycle
};

/// Circulation of a field, sigma^2 per cycle; counter-clockwise (x right, z up) is positive.
struct Circulation {
  /// [rows - 1 x plaquettes in a row] line integral of u round the loop through the centres of four adjoining
  /// cells, by the trapezoid rule; NaN where a cell is empty. By Stokes' theorem the sum over a region is the
  /// line integral round it.
  std::vector<double> plaquettes;
  std::size_t columns = 0;  ///< plaquettes in a row
  /// Of the halves; plaquettes on the middle line count half to each. NaN where a half has none.
  double left = std::numeric_limits<double>::quiet_NaN(), right = left;
};
Circulation circulation_of(const DisplacementField& field);

inline constexpr std::size_t kFieldSamples = 5;  ///< least number of displacements that make a cell's mean
/// Least filling of a cell, of close packing, mean over cycles: beads thrown about above the bed move by
/// whole sigma and would outweigh its creep.
inline constexpr double kFieldFilling = 0.75;

/// Displacements of all beads from the beginning of one cycle to that of the next, averaged over cycles in
/// cells of about AnalysisOptions::field_cell at the middle of the way; the plate is at the same height then.
/// Results displacement_field [rows x columns x 2], field_x [columns], field_z [rows] (centres of the cells),
/// circulation_left, circulation_right (intervals by leaving out blocks of cycles), rolls (rolls.hpp) and
/// convection_sense, in words. In three dimensions the field is the mean over y. Fortini & Huang 2015, sec.
/// V.
std::unique_ptr<Observable> make_convection(const AnalysisContext& context);

}  // namespace twincell
