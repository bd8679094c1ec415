// The products of the law lists, compiled here and nowhere else.

#include <utility>

#include "sim/force_pass.hpp"
#include "sim/integrate.hpp"
#include "sim/kernel.hpp"
#include "sim/reference.hpp"

namespace twincell::sim {

namespace {

template <class Laws, class Forces>
class Kernel2d : public Kernel {
 public:
  Kernel2d(Forces forces, const GuardLimits& limits) : forces_(std::move(forces)), limits_(limits) {}

  void advance(System& s, std::int64_t steps) override {
    s.forces.resize(s.beads.size());
    if (!started_) forces_(s);
    started_ = true;
    for (std::int64_t k = 0; k < steps; ++k) {
      const double largest = verlet_step<Laws::Tangential::kNeedsSpin>(s, forces_);
      if (!(largest <= limits_.overlap)) explain_overlap(s, limits_, Laws::Side::kWalls ? 0 : s.width);
      // A bead that is not finite, or fast, makes the list stale at once: looking then finds it in the same
      // step.
      if (std::exchange(builds_, forces_.builds()) != forces_.builds()) check_motion(s, limits_);
    }
    check_motion(s, limits_);
  }
  [[nodiscard]] std::int64_t list_builds() const override { return forces_.builds(); }
  void rebuild_every(std::int64_t n) override { forces_.rebuild_every(n); }

 private:
  Forces forces_;
  GuardLimits limits_;
  bool started_ = false;
  std::int64_t builds_ = 0;
};

/// Verlet skin: second neighbours of a hexagonal packing sit at 1.73 sigma, so a quarter diameter adds no
/// pairs there.
constexpr double kSkin = 0.25;

template <class N, class T, class S>
std::unique_ptr<Kernel> make(const Plan& plan, const N&, const T&, const S& side, const GuardLimits& limits,
                             KernelKind kind) {
  using Laws = LawSet<N, T, S>;
  const Laws laws{{std::get<N>(plan.bead.normal), std::get<T>(plan.bead.tangential)},
                  {std::get<N>(plan.wall.normal), std::get<T>(plan.wall.tangential)},
                  side};
  if (kind == KernelKind::all_pairs)
    return std::make_unique<Kernel2d<Laws, AllPairsForces<Laws>>>(AllPairsForces<Laws>(laws), limits);
  return std::make_unique<Kernel2d<Laws, ListForces<Laws>>>(
      ListForces<Laws>(laws, kSkin * plan.largest_diameter), limits);
}

}  // namespace

std::unique_ptr<Kernel> make_kernel(const Plan& plan, const GuardLimits& limits, KernelKind kind) {
  return std::visit(
      [&](const auto& n, const auto& t, const auto& s) { return make(plan, n, t, s, limits, kind); },
      plan.bead.normal, plan.bead.tangential, plan.side);
}

}  // namespace twincell::sim
