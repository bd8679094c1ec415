#include "reproduce/estimate.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace twincell::reproduce {

std::string Estimate::text() const {
  if (!low && !high) return fmt::format("{:.4g}", value);
  return fmt::format("{:.4g} [{}, {}]", value, low ? fmt::format("{:.4g}", *low) : "open",
                     high ? fmt::format("{:.4g}", *high) : "open");
}

Estimate exact(double value) {
  return {value, value, value};
}

Verdict within(const Estimate& e, double low, double high) {
  if (e.value >= low && e.value <= high) return Verdict::pass;
  if ((e.low && *e.low > high) || (e.high && *e.high < low)) return Verdict::fail;
  return Verdict::inconclusive;
}

Verdict above(const Estimate& a, const Estimate& b) {
  if (a.low && b.high && *a.low > *b.high) return Verdict::pass;
  if (a.high && b.low && *a.high < *b.low) return Verdict::fail;
  return Verdict::inconclusive;
}

Verdict agree(const Estimate& a, const Estimate& b) {
  if (!a.low || !a.high || !b.low || !b.high) return Verdict::inconclusive;
  return *a.low <= *b.high && *b.low <= *a.high ? Verdict::pass : Verdict::fail;
}

Verdict all_of(const std::vector<Verdict>& verdicts) {
  for (const Verdict worst : {Verdict::fail, Verdict::inconclusive, Verdict::pass})
    if (std::find(verdicts.begin(), verdicts.end(), worst) != verdicts.end()) return worst;
  return Verdict::absent;
}

}  // namespace twincell::reproduce
