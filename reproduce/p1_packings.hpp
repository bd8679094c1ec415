#pragma once
/// \file
/// Beds at rest before the drive starts, as in Figs. 1 and 2 of Fortini & Huang 2015.

#include <cstdint>
#include <functional>
#include <map>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "analysis/motion/snapshots.hpp"
#include "reproduce/reproduction.hpp"

namespace twincell::reproduce {

/// Folder of the runs that Figs. 1 and 2 share.
inline constexpr const char* kPackingRuns = "p1-packings";

/// One settled bed.
struct Packing {
  std::string start;  ///< "crystal_a", "crystal_b", "random"
  std::uint64_t seed = 0;
  std::map<std::string, double> scalars;  ///< results of the analysis, by name
  Box box;
  std::vector<double> radius;
  analysis::Snapshot moment;  ///< neighbours within 1.2 sigma

  /// "crystal A", "crystal B", "random, seed 7"
  [[nodiscard]] std::string title() const;
};

/// All beds of one number of layers.
struct Packings {
  int layers = 0;         ///< N_l
  bool complete = false;  ///< false if the time ran out
  std::vector<Packing> crystals, random;
  std::vector<std::string> conditions, cheaper;

  [[nodiscard]] const Packing* crystal(const std::string& start) const;  ///< null if absent
  /// Mean of `of` over the random beds, with a bootstrap interval over the beds. \pre there is a random bed
  [[nodiscard]] Estimate over_random(const std::function<double(const Packing&)>& of) const;
};

/// Common output of both figures, with a text line and a JSON object for every bed. \param figure called if
/// there is a bed
Reproduction reproduction_of(const Packings& all, const std::string& title, std::vector<Target> targets,
                             const std::function<std::string(const Packing&)>& line,
                             const std::function<nlohmann::json(const Packing&)>& more,
                             const std::function<analysis::Figure(const Packings&)>& figure);

/// Settles the beds, or reads those that are in Request::runs. Small budgets mean lower beds and fewer seeds.
Packings settle_packings(const Request& request);

}  // namespace twincell::reproduce
