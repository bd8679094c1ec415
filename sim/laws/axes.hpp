#pragma once
/// \file
/// The lists of contact laws, one per axis (normal, tangential, rolling): the only place that names all laws.
/// To add a law, write a file with a struct that satisfies the concept of its axis (concepts.hpp), add its
/// type to the list here, and write a verification test. `twincell keys` prints its kHelp. Scenes select the
/// law by its kWord, kernels are compiled for it, the plan derives its effects from it, and `explain` lists
/// it. Only device_laws.hpp selects from these laws, because a device supports some of them.

#include <variant>

#include "sim/laws/concepts.hpp"
#include "sim/laws/normal/cohesive.hpp"
#include "sim/laws/normal/hertz.hpp"
#include "sim/laws/normal/linear.hpp"
#include "sim/laws/normal/linear_no_tension.hpp"
#include "sim/laws/normal/velocity_dependent_restitution.hpp"
#include "sim/laws/rolling/none.hpp"
#include "sim/laws/rolling/spring.hpp"
#include "sim/laws/tangential/dashpot.hpp"
#include "sim/laws/tangential/force_clipped.hpp"
#include "sim/laws/tangential/mindlin.hpp"
#include "sim/laws/tangential/none.hpp"
#include "sim/laws/tangential/spring.hpp"
#include "sim/laws/tangential/spring_limited.hpp"

namespace twincell::sim {

using NormalAxis = std::variant<LinearSpringDashpot, NoTensionSpringDashpot, HertzViscoelastic,
                                VelocityDependentRestitution, CohesiveSpringDashpot>;
using TangentialAxis = std::variant<NoTangential, DashpotSlider, SpringSlider, SpringLimitedSlider,
                                    ForceClippedSlider, MindlinSlider>;
using RollingAxis = std::variant<NoRolling, RollingSpring>;

/// One law per axis, as types. Each kernel is compiled for one such set.
template <NormalLaw N, TangentialLaw T, RollingLaw R>
struct LawSet {
  using Normal = N;
  using Tangential = T;
  using Rolling = R;
  /// Number of remembered values per contact in D dimensions: those of the normal law, then xi, then theta.
  template <int D>
  static constexpr int kMemory = N::kMemory + (T::kHistory ? (D == 2 ? 1 : 3) : 0) +
                                 (R::kActs ? (D == 2 ? 1 : 3) : 0);
};

/// Returns the law of an axis that has this word, with its parameters read from a table.
/// \throws ConfigError for parameters that are missing or out of bounds, or if no law has this word
template <class Axis, std::size_t kIndex = 0>
Axis read_law(const std::string& word, const ContactTable& table) {
  if constexpr (kIndex == std::variant_size_v<Axis>) {
    throw ConfigError(table.where(""), "there is no contact law '" + word + "'.");
  } else {
    using Law = std::variant_alternative_t<kIndex, Axis>;
    if (word == Law::kWord) return Law::read(table);
    return read_law<Axis, kIndex + 1>(word, table);
  }
}

/// The name of a law, for texts.
template <class Axis>
std::string law_name(const Axis& axis) {
  return std::visit([](const auto& law) { return std::string(law.kName); }, axis);
}

}  // namespace twincell::sim
