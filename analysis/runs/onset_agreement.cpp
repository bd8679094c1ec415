#include "analysis/runs/onset_agreement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>

#include "core/constants.hpp"

namespace twincell::analysis {

OnsetAgreement agreement_of(const PhaseBoundary& a, const PhaseBoundary& b) {
  if ((!a.below && !a.above) || (!b.below && !b.above)) return OnsetAgreement::unknown;
  // At a strength that is above the one onset and below the other they differ, so that touching intervals are
  // apart.
  const bool apart = a.above.value_or(kInfinity) <= b.below.value_or(-kInfinity) ||
                     b.above.value_or(kInfinity) <= a.below.value_or(-kInfinity);
  return apart ? OnsetAgreement::different : OnsetAgreement::compatible;
}

namespace {
/// What both sides say of one onset, at the heights for which they say the same.
struct Agreement {
  BedPhase onset;
  std::vector<double> heights;  ///< N_l
  std::string said;
};
}  // namespace

std::vector<std::string> onset_sentences(const std::vector<PhaseBoundary>& boundaries) {
  const auto same_layers = [](const PhaseBoundary& a, const PhaseBoundary& b) {
    return same_height(a.n_l, b.n_l);
  };
  bool several = false;
  for (const PhaseBoundary& a : boundaries)
    for (const PhaseBoundary& b : boundaries)
      several = several || (a.side == Side::experiment && b.side == Side::experiment && !same_layers(a, b));
  std::vector<Agreement> agreements;
  for (const PhaseBoundary& e : boundaries) {
    if (e.side != Side::experiment) continue;
    bool twins = false;  // the experiment's own twins come before the beds of a sweep
    for (const PhaseBoundary& s : boundaries)
      twins = twins || (s.side == Side::simulation && !s.sweep && s.onset == e.onset && same_layers(e, s));
    for (const PhaseBoundary& s : boundaries) {
      if (s.side != Side::simulation || s.onset != e.onset || !same_layers(e, s) || (twins && s.sweep))
        continue;
      const OnsetAgreement agreement = agreement_of(e, s);
      if (agreement == OnsetAgreement::unknown) continue;
      const bool open = (!e.above && !s.above) || (!e.below && !s.below);
      const bool compatible = agreement == OnsetAgreement::compatible;
      const std::string said = fmt::format("Gamma {} in the experiment and {} in the {}, {}.",
                                           boundary_text(e), boundary_text(s), boundary_of(s),
                                           open         ? "not bracketed on either side"
                                           : compatible ? "compatible"
                                                        : "different");
      const auto same = std::find_if(agreements.begin(), agreements.end(), [&](const Agreement& other) {
        return other.onset == e.onset && other.said == said;
      });
      if (same == agreements.end())
        agreements.push_back({e.onset, {e.n_l}, said});
      else
        same->heights.push_back(e.n_l);
    }
  }
  std::vector<std::string> sentences;
  for (const Agreement& a : agreements)
    sentences.push_back(fmt::format(
        "Onset of {}{}: {}", onset_name(a.onset),
        several ? fmt::format(" at N_l = {:.3g}", fmt::join(a.heights, " and ")) : std::string(), a.said));
  return sentences;
}

}  // namespace twincell::analysis
