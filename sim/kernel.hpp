#pragma once
/// \file
/// The run-time face of the compiled kernels.

#include <cstdint>
#include <memory>

#include "sim/guard.hpp"
#include "sim/plan.hpp"
#include "sim/state.hpp"

namespace twincell::sim {

/// Moves a System. One virtual call per block of steps, none inside.
class Kernel {
 public:
  virtual ~Kernel() = default;
  /// \throws RunError from guard.hpp naming step, bead and likely cause
  virtual void advance(System& system, std::int64_t steps) = 0;
  /// How often the neighbour list was built.
  [[nodiscard]] virtual std::int64_t list_builds() const = 0;
  /// For tests: rebuild the list at every n-th step as well.
  virtual void rebuild_every(std::int64_t n) = 0;
};

enum class KernelKind { list, all_pairs };

/// The kernel of a plan: the product of its laws, compiled in kernel_2d.cpp.
std::unique_ptr<Kernel> make_kernel(const Plan& plan, const GuardLimits& limits,
                                    KernelKind kind = KernelKind::list);

}  // namespace twincell::sim
