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

Fate within(const Estimate& e, double low, double high) {
  if (e.value >= low && e.value <= high) return Fate::met;
  if ((e.low && *e.low > high) || (e.high && *e.high < low)) return Fate::missed;
  return Fate::open;
}

Fate above(const Estimate& a, const Estimate& b) {
  if (a.low && b.high && *a.low > *b.high) return Fate::met;
  if (a.high && b.low && *a.high < *b.low) return Fate::missed;
  return Fate::open;
}

Fate agree(const Estimate& a, const Estimate& b) {
  if (!a.low || !a.high || !b.low || !b.high) return Fate::open;
  return *a.low <= *b.high && *b.low <= *a.high ? Fate::met : Fate::missed;
}

Fate all_of(const std::vector<Fate>& fates) {
  for (const Fate worst : {Fate::missed, Fate::open, Fate::met})
    if (std::find(fates.begin(), fates.end(), worst) != fates.end()) return worst;
  return Fate::absent;
}

}  // namespace twincell::reproduce
