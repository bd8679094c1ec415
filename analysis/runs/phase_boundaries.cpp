#include "analysis/runs/phase_boundaries.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "analysis/runs/phase_evidence.hpp"

namespace twincell::analysis {
namespace {

/// Drive strengths of the runs with and without a phase.
struct Gammas {
  std::vector<double> with, without;
};

/// Sets the bracket of a boundary.
void bracket(const Gammas& gammas, PhaseBoundary& boundary) {
  for (const double g : gammas.without) boundary.below = std::max(boundary.below.value_or(g), g);
  for (const double g : gammas.with) boundary.above = std::min(boundary.above.value_or(g), g);
  if (!boundary.below || !boundary.above || *boundary.above > *boundary.below) return;
  // Seeds differ: the bracket extends to the next runs on either side of the overlap, and is open without
  // one.
  boundary.overlap = true;
  const double first = *boundary.above, last = *boundary.below;
  boundary.below.reset();
  boundary.above.reset();
  for (const double g : gammas.without)
    if (g < first) boundary.below = std::max(boundary.below.value_or(g), g);
  for (const double g : gammas.with)
    if (g > last) boundary.above = std::min(boundary.above.value_or(g), g);
}

}  // namespace

std::optional<double> PhaseBoundary::gamma() const {
  if (fitted || !below || !above) return fitted;
  return (*below + *above) / 2;
}

std::optional<double> PhaseBoundary::half_width() const {
  if (!below || !above) return std::nullopt;
  return std::abs(*above - *below) / 2;
}

std::vector<PhaseBoundary> find_boundaries(const std::vector<Run>& runs) {
  std::vector<PhaseBoundary> found;
  std::vector<Gammas> gammas;
  for (const BedPhase onset : {BedPhase::bouncing, BedPhase::convecting}) {
    std::vector<double> leaders;  // N_l of the first run of each boundary
    std::vector<double> members;  // runs of each boundary, undecided ones too
    const std::size_t first = found.size();
    for (const Run& run : runs) {
      if (run.phase == BedPhase::undetermined) continue;
      std::size_t b = first;
      while (b < found.size() && !(found[b].side == run.side && found[b].start == run.start &&
                                   same_height(leaders[b - first], run.n_l)))
        ++b;
      if (b == found.size()) {
        found.push_back({.side = run.side, .start = run.start, .onset = onset});
        gammas.emplace_back();
        leaders.push_back(run.n_l);
        members.push_back(0);
      }
      PhaseBoundary& boundary = found[b];
      boundary.n_l += (run.n_l - boundary.n_l) / ++members[b - first];
      const OnsetEvidence evidence = evidence_of(run, onset);
      if (evidence == OnsetEvidence::undecided) continue;
      (evidence == OnsetEvidence::present ? gammas[b].with : gammas[b].without).push_back(run.gamma);
      ++boundary.n_runs;
    }
  }
  for (std::size_t b = 0; b < found.size(); ++b) bracket(gammas[b], found[b]);
  std::stable_sort(found.begin(), found.end(),
                   [](const PhaseBoundary& a, const PhaseBoundary& b) { return a.n_l < b.n_l; });
  return found;
}

std::string boundary_of(const PhaseBoundary& boundary) {
  if (!boundary.sweep && boundary.start == "trajectory") return "twins";
  const std::string comma = boundary.start.empty() || boundary.axes.empty() ? "" : ", ",
                    which = boundary.start + comma + boundary.axes;
  return (boundary.sweep ? "sweep" : side_name(boundary.side)) +
         (which.empty() ? "" : fmt::format(" ({})", which));
}

std::string boundary_text(const PhaseBoundary& boundary) {
  if (boundary.fitted && !boundary.half_width())
    return fmt::format("{:.3g}, interval open", *boundary.fitted);
  if (boundary.fitted) return fmt::format("{:.3g} ± {:.2g}", *boundary.fitted, *boundary.half_width());
  if (boundary.below && boundary.above)
    return fmt::format("between {:.3g} and {:.3g}", *boundary.below, *boundary.above);
  if (!boundary.below && !boundary.above)
    return boundary.overlap ? "undetermined (runs differ)" : boundary.n_runs > 0 ? "not found" : "undecided";
  return boundary.below ? fmt::format("above {:.3g}", *boundary.below)
                        : fmt::format("below {:.3g}", *boundary.above);
}

}  // namespace twincell::analysis
