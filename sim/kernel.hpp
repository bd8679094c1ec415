#pragma once
/// \file
/// The run-time face of the kernels.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "analysis/trajectory/trajectory.hpp"
#include "sim/guard.hpp"
#include "sim/plan.hpp"
#include "sim/state.hpp"

namespace twincell::sim {

/// Length of ContactMemory::values under a plan: those of its laws, and what its integrator keeps beside.
std::size_t remembered_numbers(const Plan& plan);

/// Moves a System. One virtual call per block of steps, none inside.
///
/// The bits of a run depend on the scene and the start alone: not on how steps are cut into calls, when lists
/// are built, how wide the vectors are, or how many threads share the work.
class Kernel {
 public:
  virtual ~Kernel() = default;
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

enum class KernelKind {
  best,    ///< what the plan asks for, with the widest vectors that this processor has
  scalar,  ///< one contact at a time
  avx2,    ///< \throws ConfigError where the processor lacks it
  avx512,
  all_pairs,  ///< the oracle: every pair at every step, nothing clever
};

/// The kernel of a plan.
/// \param threads for one system; 0: as many as its size is worth
std::unique_ptr<Kernel> make_kernel(const Plan& plan, const GuardLimits& limits,
                                    KernelKind kind = KernelKind::best, int threads = 1);

/// Whether this processor can run a kind.
bool available(KernelKind kind);

}  // namespace twincell::sim
