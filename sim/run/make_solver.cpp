#include "sim/run/make_solver.hpp"

#include "core/error.hpp"
#include "sim/device/device_solver.hpp"
#include "sim/event_driven/event_driven_solver.hpp"
#include "sim/stepping/list_solver.hpp"

namespace twincell::sim {

bool available(SolverKind kind) {
  switch (kind) {
    case SolverKind::avx2:
      return kAvx2.available();
    case SolverKind::avx512:
      return kAvx512.available();
    default:
      return true;
  }
}

std::unique_ptr<Solver> make_solver(const Plan& plan, const GuardLimits& limits, SolverKind kind,
                                    int threads) {
  if (!available(kind))
    throw ConfigError({.file = {}, .key = "kernel"},
                      "this processor does not support the requested instruction set.");
  switch (kind) {
    case SolverKind::all_pairs:
      return make_all_pairs_solver(plan, limits, kScalar);
    case SolverKind::scalar:
      return make_list_solver(plan, limits, kScalar, threads);
    case SolverKind::avx2:
      return make_list_solver(plan, limits, kAvx2, threads);
    case SolverKind::avx512:
      return make_list_solver(plan, limits, kAvx512, threads);
    case SolverKind::gpu:
      return make_device_solver(plan, limits, gpu_batcher());
    case SolverKind::device_on_host:
      return make_device_solver(plan, limits, host_batcher());
    case SolverKind::best:
      break;
  }
  const Target& widest = widest_target();
  if (!plan.event_driven) return make_list_solver(plan, limits, widest, threads);
  return make_event_driven_solver(
      plan, limits,
      {[plan, limits, &widest, threads] { return make_list_solver(plan, limits, widest, threads); },
       [plan, limits, &widest] { return make_all_pairs_solver(plan, limits, widest); }});
}

std::string graphics_card() {
  return gpu_batcher().executor().description();
}

}  // namespace twincell::sim
