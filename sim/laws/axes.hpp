#pragma once
/// \file
/// One list per axis of physics: the only place where the names of laws meet. To add a law: a file with a
/// struct that satisfies the axis's concept (concepts.hpp), its word in the list here, and a verification
/// test. Scenes find it by its kWord, kernels are compiled for it, `explain` names it.

#include <variant>

#include "sim/laws/concepts.hpp"
#include "sim/laws/normal/clipped.hpp"
#include "sim/laws/normal/cohesive.hpp"
#include "sim/laws/normal/falling_restitution.hpp"
#include "sim/laws/normal/hertz.hpp"
#include "sim/laws/normal/linear.hpp"
#include "sim/laws/rolling/none.hpp"
#include "sim/laws/rolling/spring.hpp"
#include "sim/laws/tangential/dashpot.hpp"
#include "sim/laws/tangential/force_clipped.hpp"
#include "sim/laws/tangential/mindlin.hpp"
#include "sim/laws/tangential/none.hpp"
#include "sim/laws/tangential/spring.hpp"
#include "sim/laws/tangential/spring_only.hpp"

namespace twincell::sim {

using NormalAxis = std::variant<LinearSpringDashpot, ClippedSpringDashpot, HertzViscoelastic,
                                FallingRestitution, CohesiveSpringDashpot>;
using TangentialAxis = std::variant<NoTangential, DashpotSlider, SpringSlider, SpringOnlySlider,
                                    ForceClippedSlider, MindlinSlider>;
using RollingAxis = std::variant<NoRolling, RollingSpring>;

/// One law per axis, as types: what a kernel is compiled for.
template <NormalLaw N, TangentialLaw T, RollingLaw R>
struct LawSet {
  using Normal = N;
  using Tangential = T;
  using Rolling = R;
  /// Numbers remembered per contact in D dimensions: the normal law's, then xi, then theta.
  template <int D>
  static constexpr int kMemory = N::kMemory + (T::kHistory ? (D == 2 ? 1 : 3) : 0) +
                                 (R::kActs ? (D == 2 ? 1 : 3) : 0);
};

/// The law of an axis that a word names, with its parameters from a table.
/// \throws ConfigError for parameters missing or out of bounds, or a word that names no law
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

/// Whether the named laws find what they need in a table. \throws ConfigError
void check_laws(const std::string& normal, const std::string& tangential, const std::string& rolling,
                const ContactTable& table);

/// The words of an axis, for scenes and messages.
std::vector<std::string> normal_words();
std::vector<std::string> tangential_words();
std::vector<std::string> rolling_words();
/// Whether the named tangential law has a spring that remembers.
bool has_history(const std::string& tangential);
/// The keys that the named laws read.
std::vector<std::string> keys_of(const std::string& normal, const std::string& tangential,
                                 const std::string& rolling);
/// The keys of all laws.
std::vector<std::string> all_law_keys();
/// The axis to which a key of all_law_keys() belongs ("normal") and the words of the laws that read it.
struct KeyReaders {
  std::string axis;
  std::vector<std::string> laws;
};
KeyReaders readers_of(const std::string& key);

}  // namespace twincell::sim
