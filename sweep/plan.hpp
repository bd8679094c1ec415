#pragma once
/// \file
/// What a sweep is to find out: a base scene, the axes along which it is varied, and either a grid or a
/// search for the place where a verdict flips. Every key: docs/sweeps.md.

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace twincell::sweep {

/// Values that one key of the scene takes.
struct Axis {
  std::string key;                  ///< "drive.gamma"
  std::vector<std::string> values;  ///< as TOML
  long line = 0;                    ///< of the plan, for messages
};

/// A question with the answers yes and no: is the scalar `result` of the analysis above `above`?
struct Verdict {
  std::string name;    ///< "bouncing", "convecting", or the result's own name
  std::string result;  ///< "s_b", "s_c", ...
  double above = 0;
};

/// A search along one more axis for the place where the verdict turns from no to yes.
struct Search {
  std::string key;           ///< "drive.gamma"
  double low = 0, high = 0;  ///< range
  double width = 0;          ///< wanted of the 95 % interval
  int runs = 24;             ///< at most, for one set of the other axes
  int batch = 3;             ///< runs decided on together
};

struct Plan {
  std::string file;                    ///< for messages
  std::string text;                    ///< as TOML, keys in order; what the collected file says of the plan
  std::string scene;                   ///< TOML of the base scene
  std::string scene_name;              ///< for messages
  std::filesystem::path scene_folder;  ///< where a relative start.from begins: that of the base scene's file
  std::uint64_t seed = 1;              ///< master seed
  std::vector<Axis> axes;              ///< in the order of their keys
  int seeds = 1;                       ///< runs of every point of a grid
  std::optional<Verdict> verdict;
  std::optional<Search> search;
  bool stop_early = false;           ///< end a run when its verdict is settled (stop_rule.hpp)
  std::vector<std::string> results;  ///< names of the analysis wanted; empty: all
};

/// Reads a plan. \throws InputError, ConfigError naming file, line, key, value and bound
Plan read_plan(const std::filesystem::path& path);
/// The same from text. \param folder in which the scene's file is looked for
Plan read_plan_text(const std::string& text, const std::string& name,
                    const std::filesystem::path& folder = ".");

/// One run of a sweep.
struct Point {
  std::string id;                   ///< 16 hex digits: of the scene, its files, and what is kept of the run
  std::vector<std::string> values;  ///< of the axes, in their order, as TOML
  std::optional<double> at;         ///< of the search's key
  int replica = 0;                  ///< which of the runs that differ in the seed alone
  std::uint64_t seed = 0;
  bool chance = true;  ///< whether another seed makes another run (sim::has_chance)
  std::string scene;   ///< resolved, as TOML
  double work = 0;     ///< particle-steps
  double memory =
      0;  ///< bytes that its run takes (sim/scene/resource_demand.hpp); 0 where a file says the beads
};

/// The point of a plan at these values. Its seed is drawn from the master seed, the rest of the scene and the
/// replica, unless an axis names start.seed; so it is the same in whatever sweep, order or process it is
/// made. \throws ConfigError for a scene that cannot be
Point make_point(const Plan& plan, const std::vector<std::string>& values, std::optional<double> at,
                 int replica);

/// Every combination of the axes' values, the last axis fastest; one empty combination without axes.
std::vector<std::vector<std::string>> combinations(const std::vector<Axis>& axes);

}  // namespace twincell::sweep
