#pragma once
/// \file
/// Measured numbers with intervals, and how they fare against a target.

#include <optional>
#include <string>
#include <vector>

#include "reproduce/reproduction.hpp"

namespace twincell::reproduce {

/// A measured number.
struct Estimate {
  double value = 0;
  std::optional<double> low, high;  ///< 95 %
  /// "0.412 [0.405, 0.419]"
  [[nodiscard]] std::string text() const;
};

/// A number without error, as a closed form gives it.
Estimate exact(double value);

/// met: the value lies within; missed: the whole interval does not; open: the interval does not decide.
Verdict within(const Estimate& e, double low, double high);
/// met: a's interval lies above b's; missed: below; else open.
Verdict above(const Estimate& a, const Estimate& b);
/// met: the intervals overlap; missed: they do not; open: one of them is not closed.
Verdict agree(const Estimate& a, const Estimate& b);
/// The verdict on a statement that holds if each of these does: missed if one is, open if one is, absent if
/// there is none.
Verdict all_of(const std::vector<Verdict>& fates);

}  // namespace twincell::reproduce
