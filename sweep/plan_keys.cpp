#include "sweep/plan_keys.hpp"

#include <algorithm>

#include "sweep/plan.hpp"

namespace twincell::sweep {

namespace {

std::vector<KeyRow> rows() {
  const std::vector<std::string> search = {"search.range=[1.2, 3.0]", "search.width=0.1",
                                           "search.verdict=\"convecting\""};
  const auto without = [&](const std::string& key) {
    std::vector<std::string> rest = search;
    std::erase_if(rest, [&](const std::string& line) { return line.starts_with("search." + key + "="); });
    return rest;
  };
  const auto threshold = [&](const std::string& other) {
    std::vector<std::string> rest = without("verdict");
    rest.push_back(other);
    return rest;
  };
  return {
      {"scene", "", "required", "\"bed.toml\"",
       "file of the base scene, relative to the plan; or a table [scene] with its keys"},
      {"seed", "", "1", "7", "master seed, from which the seed of every run is derived; --seed overrides it"},
      {"results", "", "all", "[\"s_b\", \"s_c\"]",
       "names of the requested results, as in `analyze --only`; fewer results take less time"},
      {"stop_early", "", "false", "true",
       "end a run when its verdict is settled; needs a search for bouncing or convecting", search},
      {"axes.drive.gamma", "", "", "[1.1, 1.5, 2.0]",
       "any key of a scene, here drive.gamma: a value or a list of different values. It replaces equivalent "
       "keys of the scene: drive.k_m replaces a stated Γ, beads.count the layers. All axes together make at "
       "most 10⁶ points"},
      {"axes.seeds", "", "1", "4",
       "runs of every point of a grid that differ in nothing but the seed; not together with an axis "
       "start.seed"},
      {"search.key", "", "\"drive.gamma\"", "\"drive.k_m\"", "the key of the scene that is varied", search},
      {"search.verdict", "", "required, or result and above", "\"bouncing\"",
       "the verdict whose onset is located: bouncing: s_b > σ/30; convecting: s_c > σ", without("verdict")},
      {"search.result", "", "", "\"s_b\"", "instead of verdict: any scalar result of the analysis",
       threshold("search.above=0.1")},
      {"search.above", "that of the result", "", "0.1", "instead of verdict: threshold of the result",
       threshold("search.result=\"s_b\"")},
      {"search.range", "that of the key", "required", "[1.2, 3.0]", "[from, to], increasing",
       without("range")},
      {"search.width", "that of the key", "required", "0.1",
       "requested width of the 95 % interval of the onset, at least a thousandth of the range and less than "
       "it",
       without("width")},
      {"search.runs", "", "24", "60", "largest number of runs for each combination of the axes", search},
      {"search.batch", "", "3", "8",
       "number of runs that are placed together; larger batches occupy more cores", search},
  };
}

/// The text of a plan with these assignments, and with a scene unless they state one.
std::string plan_text(const std::vector<std::string>& assignments) {
  std::string text;
  for (const std::string& assignment : assignments) text += assignment + "\n";
  const bool states_scene = std::any_of(assignments.begin(), assignments.end(),
                                        [](const std::string& line) { return line.starts_with("scene"); });
  return states_scene ? text : text + "scene.preset=\"fortini-huang-2015\"\n";
}

}  // namespace

const KeyTable& plan_keys() {
  static const KeyTable table{
      .name = "plan",
      .title = "Plan of a sweep",
      .intro = "What `sweep` computes: a grid of points, or a search for onsets (docs/sweeps.md).",
      .notes = {{"search", "Locates the value of one key at which a verdict changes from no to yes."}},
      .rows = rows(),
      .read = [](const std::vector<std::string>& assignments) {
        (void)read_plan_text(plan_text(assignments), "an example", "");
      }};
  return table;
}

}  // namespace twincell::sweep
