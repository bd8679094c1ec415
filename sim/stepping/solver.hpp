#pragma once
/// \file
/// Interface of the solvers, which advance a system in time.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "sim/scene/plan.hpp"
#include "sim/system/system.hpp"
#include "trajectory/trajectory.hpp"

namespace twincell::sim {

/// Advances a System in time. There is one virtual call per block of steps and none inside.
///
/// The bits of a run depend only on the scene and the start. They do not depend on how the steps are divided
/// into calls, when lists are built, how wide the SIMD vectors are, or how many threads share the work.
class Solver {
 public:
  virtual ~Solver() = default;
  /// Advances the system by a number of steps.
  /// \throws RunError from guard.hpp, naming step, bead and likely cause
  virtual void advance(System& system, std::int64_t steps) = 0;
  /// Advances by each of several numbers of steps, above 0, in turn, and calls `after` after each. It may
  /// read the system but neither change it nor throw: a device computes all pieces before the first call.
  virtual void advance_in_pieces(System& system, const std::vector<std::int64_t>& pieces,
                                 const std::function<void()>& after) {
    for (const std::int64_t steps : pieces) {
      advance(system, steps);
      after();
    }
  }
  /// Number of builds of the neighbour list.
  [[nodiscard]] virtual std::int64_t list_builds() const = 0;
  /// For tests: also rebuild the list at every n-th step.
  virtual void rebuild_every(std::int64_t n) = 0;
  /// All contacts with nonzero contact memory, sorted by (i, j): the data that a checkpoint needs in addition
  /// to the System.
  [[nodiscard]] virtual std::vector<ContactMemory> contacts() const = 0;
  /// Accepts contacts() of another solver with the same plan; call before the first advance.
  virtual void restore(std::vector<ContactMemory> contacts) = 0;
  /// Further data that the continuation of a run depends on, for a checkpoint.
  [[nodiscard]] virtual std::vector<double> memory() const { return {}; }
  /// Accepts memory() of another solver with the same plan, at the same step; call after restore().
  virtual void recall(const System& /*system*/, const std::vector<double>& /*memory*/) {}
  /// Instruction set and number of contacts at a time: "AVX-512, 8 contacts at a time".
  [[nodiscard]] virtual std::string description() const = 0;
  /// Totals over all steps so far: steps, visited pairs and wall contacts (with padding), builds of the inner
  /// list, and the bytes of the records of beads and contacts that the steps read and wrote, each counted
  /// once per step. `bytes` is 0 if they are not counted.
  struct Counters {
    std::int64_t steps = 0, pair_visits = 0, wall_visits = 0, near_refreshes = 0;
    double bytes = 0;
  };
  [[nodiscard]] virtual Counters counters() const { return {}; }
  /// Bytes in use for beads and for listed pairs and wall contacts, and the number of the listed contacts.
  struct Footprint {
    std::size_t beads = 0, pairs = 0, listed = 0;
  };
  [[nodiscard]] virtual Footprint footprint() const { return {}; }
};

/// Number of threads for this number of beads: `asked`, but at most one per bead. If `asked` is 0, the number
/// of processors, limited so that each thread has enough beads to repay its synchronisation.
int threads_for(std::size_t beads, int asked);

}  // namespace twincell::sim
