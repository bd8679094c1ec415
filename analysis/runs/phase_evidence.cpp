#include "analysis/runs/phase_evidence.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <set>

#include "analysis/motion/tracer_line.hpp"

namespace twincell::analysis {

namespace {

constexpr double kDecides = 1.96;  // standard errors: the end of a 95 % interval

/// A measure with the threshold of its onset.
struct Measure {
  const Result* result;  ///< null: not measured
  double threshold;

  [[nodiscard]] bool is_open() const {
    return result != nullptr && result->interval && result->interval->low <= threshold &&
           threshold <= result->interval->high;
  }
  /// Distance from the threshold in standard errors of the interval's side that faces it; at least that of
  /// the end of an interval if it is not open.
  [[nodiscard]] double clearance() const {
    if (!is_open()) return kDecides;
    const double value = result->value(), low = result->interval->low, high = result->interval->high;
    const double side = value > threshold ? value - low : high - value;
    return side > 0 ? kDecides * std::abs(value - threshold) / side : 0;
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

/// Which thresholds the runs of a side are clear of, together.
struct Clear {
  bool of_bouncing = false, of_convection = false;
};

/// Independent runs on the same side of a threshold, none of which need be clear of it by itself: the sum of
/// their distances in standard errors has the standard error sqrt(n) (Stouffer 1949).
Clear clear_together(const std::vector<Run>& runs, const std::vector<std::size_t>& members) {
  double bouncing = 0, convection = 0;
  for (const std::size_t i : members) {
    bouncing += bouncing_of(runs[i]).clearance();
    convection += only_annealed(runs[i]) ? 0 : convection_of(runs[i]).clearance();
  }
  const double enough = kDecides * std::sqrt(static_cast<double>(members.size()));
  return {bouncing >= enough, convection >= enough};
}

std::vector<BedPhase> possible_phases(const Run& run, const Clear& clear) {
  if (run.phase == BedPhase::undetermined) return {};
  const Measure s_b = bouncing_of(run), s_c = convection_of(run);
  const double convection = s_c.result != nullptr ? s_c.result->value() : std::nan("");
  const bool rests = run.phase == BedPhase::co_moving,
             // Of a bed at rest, s_c shows what it would be if it bounced.
      convects = rests ? convection > kConvectionThreshold : run.phase == BedPhase::convecting,
             either = !clear.of_convection &&
                      (s_c.is_open() || only_annealed(run) || (rests && std::isnan(convection))),
             between = !clear.of_bouncing && s_b.is_open();
  const bool may_rest = rests || between, may_leave = !rests || between;
  std::vector<BedPhase> possible;
  if (may_rest) possible.push_back(BedPhase::co_moving);
  if (may_leave && (!convects || either)) possible.push_back(BedPhase::bouncing);
  if (may_leave && (convects || either)) possible.push_back(BedPhase::convecting);
  return possible;
}

}  // namespace

std::vector<BedPhase> possible_phases(const Run& run) {
  return possible_phases(run, {});
}

std::vector<BedPhase> possible_phases(const std::vector<Run>& runs, const std::vector<std::size_t>& members) {
  if (common_phase(runs, members) == BedPhase::undetermined) return {};
  const Clear clear = clear_together(runs, members);
  std::set<BedPhase> all;
  for (const std::size_t i : members) {
    const std::vector<BedPhase> of_run = possible_phases(runs[i], clear);
    all.insert(of_run.begin(), of_run.end());
  }
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
