#include "sim/kernel.hpp"

#include "analysis/trajectory/error.hpp"
#include "sim/list_kernel.hpp"

namespace twincell::sim {

bool available(KernelKind kind) {
  switch (kind) {
    case KernelKind::avx2:
      return kAvx2.available();
    case KernelKind::avx512:
      return kAvx512.available();
    default:
      return true;
  }
}

std::unique_ptr<Kernel> make_kernel(const Plan& plan, const GuardLimits& limits, KernelKind kind,
                                    int threads) {
  if (!available(kind))
    throw ConfigError({.file = {}, .key = "kernel"},
                      "this processor lacks the instruction set that was asked for.");
  switch (kind) {
    case KernelKind::all_pairs:
      return make_all_pairs_kernel(plan, limits);
    case KernelKind::scalar:
      return make_list_kernel(plan, limits, kScalar, threads);
    case KernelKind::avx2:
      return make_list_kernel(plan, limits, kAvx2, threads);
    case KernelKind::avx512:
      return make_list_kernel(plan, limits, kAvx512, threads);
    case KernelKind::best:
      break;
  }
  return make_list_kernel(plan, limits,
                          kAvx512.available() ? kAvx512
                          : kAvx2.available() ? kAvx2
                                              : kScalar,
                          threads);
}

}  // namespace twincell::sim
