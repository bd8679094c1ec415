#pragma once
/// \file
/// What moves a system: the interface of all kernels.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/scene/plan.hpp"
#include "sim/stepping/guard.hpp"
#include "sim/system/system.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sim {

/// Moves a System. One virtual call per block of steps, none inside.
///
/// The bits of a run depend on the scene and the start alone: not on how steps are cut into calls, when lists
/// are built, how wide the vectors are, or how many threads share the work.
class Solver {
 public:
  virtual ~Solver() = default;
  /// \throws RunError from guard.hpp naming step, bead and likely cause
  virtual void advance(System& system, std::int64_t steps) = 0;
  /// How often the neighbour list was built.
  [[nodiscard]] virtual std::int64_t list_builds() const = 0;
  /// For tests: rebuild the list at every n-th step as well.
  virtual void rebuild_every(std::int64_t n) = 0;
  /// All contacts that remember something, sorted by (i, j): what a checkpoint must hold besides the System.
  [[nodiscard]] virtual std::vector<ContactMemory> contacts() const = 0;
  /// Takes up contacts() of another kernel of the same plan; call before the first advance.
  virtual void restore(std::vector<ContactMemory> contacts) = 0;
  /// What else the rest of a run depends on, for a checkpoint.
  [[nodiscard]] virtual std::vector<double> memory() const { return {}; }
  /// Takes up memory() of another kernel of the same plan, after restore(), at the same step.
  virtual void recall(const System& /*system*/, const std::vector<double>& /*memory*/) {}
  /// Instruction set, and what it costs: "AVX-512, 8 contacts at a time".
  [[nodiscard]] virtual std::string description() const = 0;
  /// Mean share of the listed pairs that were looked at per step, and lists of near pairs made.
  struct Counters {
    std::int64_t steps = 0, pair_visits = 0, wall_visits = 0, near_refreshes = 0;
  };
  [[nodiscard]] virtual Counters counters() const { return {}; }
  /// Bytes held now for beads and for listed pairs and wall contacts, and how many of the latter.
  struct Footprint {
    std::size_t beads = 0, pairs = 0, listed = 0;
  };
  [[nodiscard]] virtual Footprint footprint() const { return {}; }
};

/// Threads worth using on so many beads: `asked`, but not more than beads; 0: as many as the processor has,
/// each with enough beads to repay its waiting.
int threads_for(std::size_t beads, int asked);

}  // namespace twincell::sim
