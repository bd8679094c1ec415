#include "analysis/report/conclusion.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <utility>

#include "analysis/runs/match_verdict.hpp"
#include "analysis/runs/onset_agreement.hpp"
#include "analysis/runs/phase_evidence.hpp"
#include "core/plural.hpp"

namespace twincell::analysis {

std::string phases_of(const std::vector<Run>& runs, const std::vector<std::size_t>& members) {
  if (members.empty()) return "no run";
  const BedPhase common = common_phase(runs, members);
  if (common != BedPhase::undetermined || members.size() == 1) return phase_name(common);
  std::vector<std::string> names;
  names.reserve(members.size());
  for (const std::size_t i : members) names.push_back(phase_name(runs[i].phase));
  return fmt::format("{}", fmt::join(names, " / "));
}

namespace {

/// How many numbers really differ, the first of them by name, and what their errors leave out.
std::vector<std::string> real_differences(const Comparison& c) {
  constexpr std::size_t kMaxNamed = 5;
  const bool heights = heights_of(c.matches).size() > 1;
  std::vector<std::string> names;
  std::size_t without_error = 0, without_seeds = 0, not_filmed = 0;
  for (const Difference& d : c.differences) {
    if (!d.in_errors()) ++without_error;
    if (d.is_real() && !d.seeds) ++without_seeds;
    if (d.is_real() && !d.camera) ++not_filmed;
    if (d.is_real())
      names.push_back(fmt::format("{} at {}", d.quantity, condition_text(c.matches[d.match], heights)));
  }
  if (c.differences.empty()) return {};
  if (names.empty())
    return {fmt::format("None of the {} compared numbers really differs{}.", c.differences.size(),
                        without_error > 0 ? fmt::format("; of {} no error is known", without_error) : "")};
  const std::size_t n = names.size();
  if (n > kMaxNamed) names.resize(kMaxNamed);
  std::vector<std::string> text = {
      fmt::format("{} of the {} compared numbers really differ{}.", n, c.differences.size(),
                  n == 1 ? "s" : ""),
      fmt::format("{} {}{}.", n == 1 ? "It is" : "They are", fmt::join(names, heights ? "; " : ", "),
                  n > kMaxNamed ? fmt::format(" and {} more", n - kMaxNamed) : "")};
  const std::size_t compared = c.differences.size() - without_error;
  if (static_cast<double>(compared) * kFalseShare >= 1)
    text.push_back(
        fmt::format("Among {} numbers with known errors, a difference counts from {:.2g} errors on, so that "
                    "at most about {:.0f} % of such differences are chance.",
                    compared, c.differences.front().significant, 100 * kFalseShare));
  if (not_filmed == n)
    text.push_back(
        fmt::format("Nothing was filmed, so that camera and tracking may cause {}.", n == 1 ? "it" : "them"));
  if (without_seeds > 0)
    text.push_back(fmt::format(
        "The error of {} contains no scatter between seeds, as there is one simulation of each start: other "
        "seeds may differ as much.",
        without_seeds == n ? (n == 1 ? std::string("this") : "these")
                           : fmt::format("{} of these", without_seeds)));
  return text;
}

/// Why the phases of a match are undecided: "in the simulation s_c = 1.18 [0.79, 1.84], threshold 1".
std::string doubts_of(const std::vector<Run>& runs, const Match& match) {
  std::vector<std::string> sides;
  for (const auto* members : {&match.experiments, &match.simulations}) {
    if (possible_phases(runs, *members).size() < 2) continue;
    std::vector<std::string> doubts;
    for (const std::size_t i : *members)
      if (std::string doubt = doubt_text(runs[i]); !doubt.empty()) doubts.push_back(std::move(doubt));
    sides.push_back(
        fmt::format("in the {} {}", side_name(runs[members->front()].side), fmt::join(doubts, " and ")));
  }
  return fmt::format("{}", fmt::join(sides, "; "));
}

std::vector<std::string> conclusion_of_sweep(const Comparison& c) {
  std::vector<std::string> text = {
      fmt::format("The diagram shows {} of a sweep.", plural(c.sweep.size(), "point"))};
  for (const PhaseBoundary& b : c.boundaries)
    text.push_back(fmt::format("Onset of {} ({}, N_l = {:.3g}): Gamma {}.", onset_name(b.onset),
                               boundary_of(b), b.n_l, boundary_text(b)));
  return text;
}

}  // namespace

std::vector<std::string> conclusion_sentences(const Comparison& c) {
  const std::vector<Run>& runs = c.runs;
  const std::vector<Match>& matches = c.matches;
  if (runs.empty() && (!c.sweep.empty() || !c.boundaries.empty())) return conclusion_of_sweep(c);
  const bool heights = heights_of(matches).size() > 1;
  std::vector<std::string> differ, undecided, open;
  std::size_t paired = 0, same = 0;
  for (const Match& match : matches) {
    if (match.experiments.empty() || match.simulations.empty()) continue;
    ++paired;
    const std::string word = verdict_word(runs, match);
    if (word == "same") {
      ++same;
      continue;
    }
    if (word == "undecided") {
      undecided.push_back(fmt::format("{} ({})", condition_text(match, heights), doubts_of(runs, match)));
      continue;
    }
    (word == "differ" ? differ : open)
        .push_back(fmt::format("{} ({} in the experiment, {} in the simulation)",
                               condition_text(match, heights), phases_of(runs, match.experiments),
                               phases_of(runs, match.simulations)));
  }
  if (paired == 0)
    return {heights_of(matches).size() > 1
                ? "No drive strength was run on both sides at the same height of the bed."
                : "No drive strength was run on both sides."};
  std::vector<std::string> text = {
      fmt::format("Same phase on both sides at {} of {} {}.", same, paired,
                  heights ? "points (drive strength and height)" : "drive strengths")};
  if (!differ.empty()) text.push_back(fmt::format("They differ at {}.", fmt::join(differ, "; ")));
  if (!undecided.empty()) text.push_back(fmt::format("Undecided at {}.", fmt::join(undecided, "; ")));
  if (!open.empty()) text.push_back(fmt::format("Undetermined at {}.", fmt::join(open, "; ")));
  for (std::string& onset : onset_sentences(c.boundaries)) text.push_back(std::move(onset));
  for (std::string& real : real_differences(c)) text.push_back(std::move(real));
  return text;
}

}  // namespace twincell::analysis
