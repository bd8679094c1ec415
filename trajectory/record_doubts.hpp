#pragma once
/// \file
/// Doubts about a record of a plate's motion that can be read but may not be what its user believes.

#include <string>
#include <vector>

namespace twincell {

/// Whether an instrument was overloaded: the record was cut off at its largest or smallest value. Runs of at
/// least three values that are exactly the extreme are counted if the values two further out differ from it
/// by more than those beside the crest of a smooth curve could, which has such runs too because of the
/// resolution of the instrument (the smallest difference of two values of the record).
/// \param values of the record, in any unit
/// \returns one sentence if there are at least two such runs, otherwise empty
std::string doubt_of_clipping(const std::vector<double>& values);

inline constexpr double kStandardGravity = 9.80665;  ///< m/s^2

/// Whether accelerations are in another unit than believed: an instrument that senses gravity shows 1 g at
/// rest, so a mean of 9.8 g or of 0.1 g (each within 3 %) belongs to values in m/s^2 named g, or the reverse.
/// \param values in units of g
/// \returns one sentence, or empty
std::string doubt_of_unit(const std::vector<double>& values);

}  // namespace twincell
