#include "analysis/runs/onset_agreement.hpp"

#include <fmt/format.h>

#include <cmath>
#include <limits>

namespace twincell::analysis {

OnsetAgreement agreement_of(const PhaseBoundary& a, const PhaseBoundary& b) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  if ((!a.below && !a.above) || (!b.below && !b.above)) return OnsetAgreement::unknown;
  const bool apart = a.above.value_or(kInfinity) < b.below.value_or(-kInfinity) ||
                     b.above.value_or(kInfinity) < a.below.value_or(-kInfinity);
  return apart ? OnsetAgreement::different : OnsetAgreement::compatible;
}

namespace {
/// "twins" for simulations that start from a filmed packing, else the side with its kind of start.
std::string name_of(const PhaseBoundary& b) {
  if (!b.sweep && b.start == "trajectory") return "twins";
  return (b.sweep ? "sweep" : side_name(b.side)) + (b.start.empty() ? "" : fmt::format(" ({})", b.start));
}
}  // namespace

std::vector<std::string> onset_sentences(const std::vector<PhaseBoundary>& boundaries) {
  constexpr double kSameLayers = 0.1;
  const auto same_layers = [](const PhaseBoundary& a, const PhaseBoundary& b) {
    return std::abs(a.n_l - b.n_l) <= kSameLayers * a.n_l;
  };
  std::vector<std::string> sentences;
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
      sentences.push_back(fmt::format("Onset of {}: Gamma {} in the experiment and {} in the {}, {}.",
                                      phase_name(e.onset), boundary_text(e), boundary_text(s), name_of(s),
                                      open         ? "not bracketed on either side"
                                      : compatible ? "compatible"
                                                   : "different"));
    }
  }
  return sentences;
}

}  // namespace twincell::analysis
