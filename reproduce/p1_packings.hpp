#pragma once
/// \file
/// Beds at rest before the drive begins: what Figs. 1 and 2 of Fortini & Huang 2015 show.

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "analysis/motion/snapshots.hpp"
#include "reproduce/estimate.hpp"
#include "reproduce/reproduction.hpp"

namespace twincell::reproduce {

/// Folder of the runs that Figs. 1 and 2 share.
inline constexpr const char* kPackingRuns = "p1-packings";

/// One bed, settled.
struct Packing {
  std::string start;  ///< "crystal_a", "crystal_b", "random"
  std::uint64_t seed = 0;
  std::map<std::string, double> scalars;  ///< results of the analysis, by name
  Box box;
  std::vector<double> radius;
  Snapshot moment;  ///< neighbours within 1.2 sigma

  /// "crystal A", "crystal B", "random, seed 7"
  [[nodiscard]] std::string title() const;
};

/// All beds of one height.
struct Packings {
  int layers = 0;         ///< N_l
  bool complete = false;  ///< false: the time was up
  std::vector<Packing> crystals, random;
  std::vector<std::string> conditions, cheaper;

  [[nodiscard]] const Packing* crystal(const std::string& start) const;  ///< null if not there
  /// Mean over the random beds, its interval by bootstrap over them. \pre there is one
  [[nodiscard]] Estimate over_random(const std::function<double(const Packing&)>& of) const;
};

/// What the two figures say alike, with a line and a JSON object of every bed. `figure` is drawn if there is
/// a bed.
Reproduction reproduction_of(const Packings& all, const std::string& title, std::vector<Target> targets,
                             const std::function<std::string(const Packing&)>& line,
                             const std::function<nlohmann::json(const Packing&)>& more,
                             const std::function<Figure(const Packings&)>& figure);

/// Settles them, or takes up what is in Request::runs. Small budgets mean lower beds and fewer seeds.
Packings settle_packings(const Request& request);

}  // namespace twincell::reproduce
