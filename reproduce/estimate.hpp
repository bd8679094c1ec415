#pragma once
/// \file
/// Measured numbers with intervals, and their verdicts against a target.

#include <optional>
#include <string>
#include <vector>

#include "reproduce/reproduction.hpp"

namespace twincell::reproduce {

/// A measured number with its interval.
struct Estimate {
  double value = 0;
  std::optional<double> low, high;  ///< 95 % interval; an absent end is open
  /// "0.412 [0.405, 0.419]"
  [[nodiscard]] std::string text() const;
};

/// A number without error, as from a closed form.
Estimate exact(double value);

/// met: the value is within [low, high]; missed: the whole interval is outside; open: neither.
Verdict within(const Estimate& e, double low, double high);
/// met: the interval of a is above that of b; missed: below; open: the intervals overlap or are not closed.
Verdict above(const Estimate& a, const Estimate& b);
/// met: the intervals overlap; missed: they do not; open: one of the intervals is not closed.
Verdict agree(const Estimate& a, const Estimate& b);
/// Verdict on a statement that is true if all of its parts are: missed if one part is missed, else open if
/// one is open, else met if one is met; absent without any of these.
Verdict all_of(const std::vector<Verdict>& verdicts);

}  // namespace twincell::reproduce
