#include "analysis/runs/phase_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/motion/tracer_line.hpp"

namespace twincell::analysis {

namespace {

/// A measure with the threshold of its onset.
struct Measure {
  const Result* result;  ///< null: not measured
  double threshold;

  [[nodiscard]] bool is_open() const {
    return result != nullptr && result->interval && result->interval->low <= threshold &&
           threshold <= result->interval->high;
  }
  [[nodiscard]] std::string text() const {
    return fmt::format("{} = {:.3g} [{:.3g}, {:.3g}], threshold {:.3g}", result->name, result->value(),
                       result->interval->low, result->interval->high, threshold);
  }
};

Measure bouncing_of(const Run& run) {
  return {seek_result(run.results, "s_b"), kBouncingThreshold};
}
Measure convection_of(const Run& run) {
  return {seek_result(run.results, "s_c"), kConvectionThreshold};
}

/// Whether s_c shows the first rearrangement instead of steady convection.
bool only_annealed(const Run& run) {
  const Result* drift = seek_result(run.results, "drift");
  return run.phase == BedPhase::convecting && drift != nullptr && drift->text == drift_name(Drift::annealed);
}

}  // namespace

std::vector<BedPhase> possible_phases(const Run& run) {
  if (run.phase == BedPhase::undetermined) return {};
  const Measure s_b = bouncing_of(run), s_c = convection_of(run);
  const double convection = s_c.result != nullptr ? s_c.result->value() : std::nan("");
  const bool rests = run.phase == BedPhase::co_moving,
             // Of a bed at rest, s_c shows what it would be if it bounced.
      convects = rests ? convection > kConvectionThreshold : run.phase == BedPhase::convecting,
             either = s_c.is_open() || only_annealed(run) || (rests && std::isnan(convection));
  const bool may_rest = rests || s_b.is_open(), may_leave = !rests || s_b.is_open();
  std::vector<BedPhase> possible;
  if (may_rest) possible.push_back(BedPhase::co_moving);
  if (may_leave && (!convects || either)) possible.push_back(BedPhase::bouncing);
  if (may_leave && (convects || either)) possible.push_back(BedPhase::convecting);
  return possible;
}

std::vector<BedPhase> possible_phases(const std::vector<Run>& runs, const std::vector<std::size_t>& members) {
  const BedPhase common = common_phase(runs, members);
  if (common == BedPhase::undetermined) return {};
  std::set<BedPhase> all;
  std::size_t decided = 0;
  for (const std::size_t i : members) {
    const std::vector<BedPhase> of_run = possible_phases(runs[i]);
    decided += of_run.size() == 1 ? 1 : 0;
    all.insert(of_run.begin(), of_run.end());
  }
  if (2 * decided > members.size()) return {common};
  return {all.begin(), all.end()};
}

std::string doubt_text(const Run& run) {
  if (possible_phases(run).size() < 2) return {};
  std::vector<std::string> parts;
  const Measure s_b = bouncing_of(run), s_c = convection_of(run);
  if (s_b.is_open()) parts.push_back(s_b.text());
  if (s_c.is_open()) parts.push_back(s_c.text());
  if (only_annealed(run))
    parts.push_back((s_c.is_open() ? "" : fmt::format("s_c = {:.3g}, ", s_c.result->value())) + "annealed");
  return fmt::format("{}", fmt::join(parts, ", "));
}

OnsetEvidence evidence_of(const Run& run, BedPhase onset) {
  const std::vector<BedPhase> possible = possible_phases(run);
  const auto has = [&](BedPhase phase) { return phase >= onset; };
  const auto with = std::count_if(possible.begin(), possible.end(), has);
  if (possible.empty() || (with > 0 && with < std::ssize(possible))) return OnsetEvidence::undecided;
  return with > 0 ? OnsetEvidence::present : OnsetEvidence::absent;
}

}  // namespace twincell::analysis
