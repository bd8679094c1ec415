// The reading of "truncate" in Fortini & Huang 2015: the targets of Figs. 4 and 5 under each slip rule.

#include <fmt/format.h>

#include <array>
#include <nlohmann/json.hpp>

#include "core/json_text.hpp"
#include "reproduce/p1_scene.hpp"
#include "reproduce/p1_sweep.hpp"

namespace twincell::reproduce {

namespace {

/// A reading of "truncate the elastic shear displacement as necessary to satisfy Coulomb's law".
struct Rule {
  const char* word;  ///< contact.tangential
  const char* name;
};
constexpr std::array<Rule, 3> kRules = {{{"spring", "spring and dashpot limited together"},
                                         {"spring-limited", "spring alone limited"},
                                         {"force-clipped", "force alone limited, the spring stretches on"}}};

/// Targets of both figures under one rule.
std::vector<Target> targets_of(const Rule& rule, const StrengthSweeps& sweeps) {
  std::vector<Target> all = targets_at_heights(sweeps, temperature_targets);
  for (Target& t : all) t.name = "Fig. 4 " + t.name;
  for (Target& t : targets_at_heights(sweeps, slip_targets)) {
    t.name = "Fig. 5 " + t.name;
    all.push_back(t);
  }
  for (Target& t : all) {
    t.name = fmt::format("{}: {}", rule.word, t.name);
    t.runs = sweeps.runs_text;
  }
  return all;
}

Reproduction run(const Request& request) {
  Reproduction r;
  r.title = "Fortini & Huang 2015: targets of Figs. 4 and 5 under each reading of \"truncate\"";
  r.complete = true;
  const nlohmann::json stored =
      request.stored.empty() ? nlohmann::json() : nlohmann::json::parse(request.stored);
  nlohmann::json measured = nlohmann::json::object();
  for (const Rule& rule : kRules) {
    Request one = request;
    if (!request.stored.empty()) one.stored = stored.at(rule.word).dump();
    // The default rule is left out of the scene, so that Figs. 4 and 5 share its runs.
    const std::string keys =
        &rule == &kRules.front() ? "" : fmt::format("contact.tangential = \"{}\"\n", rule.word);
    const StrengthSweeps sweeps = strength_sweeps(one, keys, 1.0 / kRules.size());
    const Reproduction of_rule = reproduction_of(sweeps, "");
    measured[rule.word] = nlohmann::json::parse(of_rule.measured);
    analysis::Figure figure = slip_figure(fmt::format("p1-truncate-{}", rule.word), sweeps);
    figure.caption = fmt::format("With {}. {}", rule.name, figure.caption);
    r.figures.push_back(std::move(figure));
    int good = 0, bad = 0, undecided = 0;
    for (const Target& t : targets_of(rule, sweeps)) {
      good += t.verdict == Verdict::pass || t.verdict == Verdict::consistent ? 1 : 0;
      bad += t.verdict == Verdict::fail ? 1 : 0;
      undecided += t.verdict == Verdict::inconclusive || t.verdict == Verdict::absent ? 1 : 0;
      r.targets.push_back(t);
    }
    r.table += fmt::format("  {} ({}): {} pass or consistent, {} fail, {} not decided\n{}", rule.word,
                           rule.name, good, bad, undecided, of_rule.table);
    r.complete = r.complete && sweeps.complete;
    r.runs = sweeps.runs_text;
    r.conditions = sweeps.conditions;
    r.cheaper = sweeps.cheaper;
  }
  // The conditions are those of the last rule; the rule itself is in the name of each target.
  std::erase_if(r.conditions, [](const std::string& s) { return s.starts_with("slip rule"); });
  r.conditions.emplace_back("slip rule: that in the name of the target (docs/friction.md)");
  r.measured = json_text(measured);
  return r;
}

}  // namespace

Reproducible p1_truncate() {
  return {.name = "p1-truncate",
          .what = "targets of Figs. 4 and 5 under each reading of \"truncate\", the slip rule",
          .run = run,
          .shared_runs = kStrengthSweepRuns,
          .judges_stored = true,
          .on_device = true,
          .time_share = 3,
          .judges_again = true};
}

}  // namespace twincell::reproduce
