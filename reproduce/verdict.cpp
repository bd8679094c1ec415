#include "reproduce/verdict.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace twincell::reproduce {

std::string word_of(Verdict verdict) {
  return std::string(row_of(kVerdicts, verdict).word);
}

std::string Estimate::text() const {
  if (!low && !high) return fmt::format("{:.4g}", value);
  return fmt::format("{:.4g} [{}, {}]", value, low ? fmt::format("{:.4g}", *low) : "open",
                     high ? fmt::format("{:.4g}", *high) : "open");
}

Estimate exact(double value) {
  return {value, value, value};
}

Estimate estimate_of(const sweep::Onset& onset) {
  return {onset.value.value_or(std::nan("")), onset.low, onset.high};
}

Estimate difference(const Estimate& a, const Estimate& b) {
  Estimate d{a.value - b.value, {}, {}};
  if (a.low && b.high) d.low = *a.low - *b.high;
  if (a.high && b.low) d.high = *a.high - *b.low;
  return d;
}

Verdict judge(const Estimate& measured, double low, double high) {
  const double from = measured.low.value_or(-kUnbounded), to = measured.high.value_or(kUnbounded);
  if (from > high || to < low) return Verdict::fail;
  if (from >= low && to <= high) return Verdict::pass;
  return std::isfinite(high - low) && to - from < high - low ? Verdict::consistent : Verdict::inconclusive;
}

Verdict above(const Estimate& a, const Estimate& b) {
  return judge(difference(a, b), kAboveZero, kUnbounded);
}

Verdict agree(const Estimate& a, const Estimate& b, double tolerance) {
  return judge(difference(a, b), -tolerance, tolerance);
}

Trend trend_of(const std::vector<Estimate>& series, bool rising) {
  if (series.size() < 2) return {};
  const auto clearly_above = [](const Estimate& a, const Estimate& b) {
    if (!a.low || !b.high) return -kUnbounded;
    const double half = (a.value - *a.low + *b.high - b.value) / 2;
    return *a.low - *b.high - half;
  };
  Trend trend{.verdict =
                  rising ? above(series.back(), series.front()) : above(series.front(), series.back())};
  double most = 0;
  for (std::size_t j = 1; j < series.size(); ++j)
    for (std::size_t i = 0; i < j; ++i) {
      const double by = rising ? clearly_above(series[i], series[j]) : clearly_above(series[j], series[i]);
      if (by <= most) continue;
      most = by;
      trend = {.verdict = Verdict::fail, .against = std::pair(i, j)};
    }
  return trend;
}

Verdict differ(const Estimate& a, const Estimate& b) {
  const bool separate = above(a, b) == Verdict::pass || above(b, a) == Verdict::pass;
  return separate ? Verdict::pass : Verdict::inconclusive;
}

Verdict holds(bool statement) {
  return judge(exact(statement ? 1 : 0), 1, 1);
}

Verdict above(const sweep::Onset& upper, const sweep::Onset& lower) {
  if (upper.n == 0 || lower.n == 0) return Verdict::absent;
  if (evidence_above(upper, lower) >= sweep::kLikelihoodDrop) return Verdict::pass;
  if (evidence_above(lower, upper) >= sweep::kLikelihoodDrop) return Verdict::fail;
  return Verdict::inconclusive;
}

Verdict best_of(Verdict a, Verdict b) {
  for (const Verdict best : {Verdict::pass, Verdict::consistent, Verdict::inconclusive})
    if (a == best || b == best) return best;
  return Verdict::fail;
}

Verdict all_of(const std::vector<Verdict>& verdicts) {
  for (const Verdict worst : {Verdict::fail, Verdict::inconclusive, Verdict::consistent, Verdict::pass})
    if (std::find(verdicts.begin(), verdicts.end(), worst) != verdicts.end()) return worst;
  return Verdict::absent;
}

Verdict all_of(const std::vector<Verdict>& verdicts, std::size_t cases) {
  const Verdict of_measured = all_of(verdicts);
  const bool holds = of_measured == Verdict::pass || of_measured == Verdict::consistent;
  return holds && verdicts.size() < cases ? Verdict::inconclusive : of_measured;
}

}  // namespace twincell::reproduce
