#pragma once
/// \file
/// Plan of a sweep: a base scene, the axes along which it is varied, and either a grid or a search for the
/// onset where the answer to a criterion changes. docs/sweeps.md lists every key.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace twincell::sweep {

/// Values of one key of the scene.
struct Axis {
  std::string key;                  ///< "drive.gamma"
  std::vector<std::string> values;  ///< as TOML
  long line = 0;                    ///< line in the plan, for messages
};

/// A yes-or-no question: whether the scalar `result` of the analysis exceeds `above`.
struct Criterion {
  std::string name;    ///< "bouncing", "convecting", or the result's own name
  std::string result;  ///< "s_b", "s_c", ...
  double above = 0;
};

/// A search along one more axis for the onset, where the answer to the criterion changes from no to yes.
struct Search {
  std::string key;           ///< "drive.gamma"
  double low = 0, high = 0;  ///< search range
  double width = 0;          ///< wanted width of the 95 % interval
  int runs = 24;             ///< largest number of runs for one set of the other axes
  int batch = 3;             ///< runs per round
};

/// A sweep as read from its plan file.
struct Plan {
  std::string file;                    ///< for messages
  std::string text;                    ///< as TOML with sorted keys; copied into the collected results
  std::string scene;                   ///< TOML of the base scene
  std::string scene_name;              ///< for messages
  std::filesystem::path scene_folder;  ///< of the base scene's file; start.from may be relative to it
  std::uint64_t seed = 1;              ///< master seed
  std::vector<Axis> axes;              ///< in the order of their keys
  int seeds = 1;                       ///< runs per set of axes of a grid
  std::optional<Criterion> criterion;  ///< search.verdict, or search.result and search.above
  std::optional<Search> search;
  bool stop_early = false;           ///< end a run when its criterion is decided (stop_rule.hpp)
  std::vector<std::string> results;  ///< names of the wanted results; empty: all
  std::vector<std::string> doubts;   ///< sentences on values that are possible but hardly meant
};

/// Reads a plan.
/// \throws InputError, ConfigError naming file, line, key, value and bound
Plan read_plan(const std::filesystem::path& path);
/// The same from text.
/// \param folder folder of the scene's file
Plan read_plan_text(const std::string& text, const std::string& name,
                    const std::filesystem::path& folder = ".");

/// One run of a sweep.
struct Point {
  /// 16 hex digits: hash of the resolved scene, its start file, the wanted results, the criterion with its
  /// threshold and stop_early, and the definition numbers of the results (NamedResult::definition).
  std::string id;
  std::vector<std::string> values;  ///< values of the axes, in their order, as TOML
  std::optional<double> at;         ///< value of the search's key
  int replica = 0;                  ///< index among the runs that differ only in the seed
  std::uint64_t seed = 0;
  bool chance = true;  ///< whether another seed gives another run (sim::has_chance)
  std::string scene;   ///< resolved, as TOML
  double work = 0;     ///< particle-steps
  /// Bytes that the run takes (sim/scene/resource_demand.hpp); 0 if a file states the beads.
  double memory = 0;
  std::vector<std::string> warnings;  ///< sentences on the scene, as `explain` prints them
};

/// Makes the point of a plan at these values. Its seed is a hash of the master seed, the rest of the scene
/// and the replica, unless an axis is start.seed. It is therefore the same in every sweep, order and process.
/// \throws ConfigError for an invalid scene
Point make_point(const Plan& plan, const std::vector<std::string>& values, std::optional<double> at,
                 int replica);

/// Every combination of the axes' values, the last axis fastest; one empty combination without axes.
std::vector<std::vector<std::string>> combinations(const std::vector<Axis>& axes);

}  // namespace twincell::sweep
