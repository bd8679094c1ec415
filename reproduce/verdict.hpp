#pragma once
/// \file
/// The one rule by which a measured number with its interval is compared with a target.

#include <array>
#include <cstddef>
#include <limits>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/choice.hpp"
#include "sweep/onset.hpp"

namespace twincell::reproduce {

/// Verdict on a target.
enum class Verdict { pass, consistent, fail, inconclusive, absent };
/// All verdicts with their words.
inline constexpr std::array kVerdicts = {
    Choice<Verdict>{Verdict::pass, "pass", "the interval lies inside the target"},
    Choice<Verdict>{Verdict::consistent, "consistent",
                    "interval and target overlap, and the interval is narrower than the target"},
    Choice<Verdict>{Verdict::fail, "fail", "the interval lies outside the target"},
    Choice<Verdict>{Verdict::inconclusive, "inconclusive", "the interval does not decide"},
    Choice<Verdict>{Verdict::absent, "absent", "not measured"}};
/// The word of a verdict.
std::string word_of(Verdict verdict);

/// A measured number with its interval.
struct Estimate {
  double value = 0;
  std::optional<double> low, high;  ///< 95 % interval; an absent end is open
  /// "0.412 [0.405, 0.419]"
  [[nodiscard]] std::string text() const;
};

/// A number without error, as from a closed form or a count.
Estimate exact(double value);
/// The onset with its interval. Without a most likely value, `value` is NaN. \pre there are trials
Estimate estimate_of(const sweep::Onset& onset);
/// a - b. Its interval reaches from the least to the largest difference of the two intervals, so it excludes
/// 0 exactly if the intervals are separate.
Estimate difference(const Estimate& a, const Estimate& b);

/// An end of a target that is not bounded.
inline constexpr double kUnbounded = std::numeric_limits<double>::infinity();
/// Lower end of a target "above 0".
inline constexpr double kAboveZero = std::numeric_limits<double>::min();

/// The rule: pass if the interval is inside [low, high], both ends included; fail if it is outside;
/// consistent if the two overlap and the interval is narrower than the target; else inconclusive. The value
/// inside the interval does not count. An open end of the interval reaches to infinity. A target with an
/// unbounded end has no width to compare with, so it is never consistent. \pre low <= high
Verdict judge(const Estimate& measured, double low, double high);

/// The rule for "a is above b": that of difference(a, b) for the target "above 0".
Verdict above(const Estimate& a, const Estimate& b);
/// The rule for "a is b within a tolerance": that of difference(a, b) for the target [-tolerance, tolerance].
Verdict agree(const Estimate& a, const Estimate& b, double tolerance);
/// A rise or a fall of a series.
struct Trend {
  Verdict verdict = Verdict::absent;
  /// Indices of the two elements between which the series goes furthest against the trend, if it clearly
  /// does.
  std::optional<std::pair<std::size_t, std::size_t>> against = {};
};
/// The rule for "the series rises" (or falls): that of above() for its ends, but fail if some later element
/// is below (above) an earlier one by more than their intervals, each wider by half, hold: among hundreds of
/// pairs some have separate 95 % intervals by chance. Absent for fewer than two elements.
Trend trend_of(const std::vector<Estimate>& series, bool rising);
/// The rule for "a differs from b", which no interval can refute: pass if the intervals are separate, else
/// inconclusive.
Verdict differ(const Estimate& a, const Estimate& b);
/// The rule for a statement about counts or bits, which has no interval.
Verdict holds(bool statement);
/// The rule for the order of two onsets: pass if the opposite order is excluded (sweep::evidence_above at
/// least sweep::kLikelihoodDrop), fail if the stated order is excluded, absent without runs, else
/// inconclusive.
Verdict above(const sweep::Onset& upper, const sweep::Onset& lower);
/// The better of two verdicts on alternatives of which one is to hold: the first of pass, consistent,
/// inconclusive and fail. \pre none is absent
Verdict best_of(Verdict a, Verdict b);
/// Verdict on a statement that holds if all of its parts do: the first of fail, inconclusive, consistent and
/// pass that is among the parts; absent if there is no part.
Verdict all_of(const std::vector<Verdict>& verdicts);
/// The same of a statement about `cases` cases, such as every N of a figure: inconclusive instead of
/// consistent or pass if fewer are among the parts.
Verdict all_of(const std::vector<Verdict>& verdicts, std::size_t cases);

}  // namespace twincell::reproduce
