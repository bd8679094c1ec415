#include "sim/kernel.hpp"

#include <algorithm>
#include <thread>

#include "analysis/trajectory/error.hpp"
#include "sim/flight_kernel.hpp"
#include "sim/list_kernel.hpp"

namespace twincell::sim {

int threads_for(std::size_t beads, int asked) {
  constexpr std::size_t kBeadsPerThread = 8192;  // fewer are not worth two barriers a step
  const std::size_t most = asked > 0 ? beads : beads / kBeadsPerThread;
  const std::size_t wanted =
      asked > 0 ? static_cast<std::size_t>(asked) : std::max(1U, std::thread::hardware_concurrency());
  return static_cast<int>(std::clamp<std::size_t>(wanted, 1, std::max<std::size_t>(1, most)));
}

std::size_t remembered_numbers(const Plan& plan) {
  return static_cast<std::size_t>(kScalar.find(plan.key).remembered);
}

const Target& widest_target() {
  static const Target& widest = kAvx512.available() ? kAvx512 : kAvx2.available() ? kAvx2 : kScalar;
  return widest;
}

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
      return make_all_pairs_kernel(plan, limits, kScalar);
    case KernelKind::scalar:
      return make_list_kernel(plan, limits, kScalar, threads);
    case KernelKind::avx2:
      return make_list_kernel(plan, limits, kAvx2, threads);
    case KernelKind::avx512:
      return make_list_kernel(plan, limits, kAvx512, threads);
    case KernelKind::best:
      break;
  }
  const Target& widest = widest_target();
  if (!plan.flights) return make_list_kernel(plan, limits, widest, threads);
  return make_flight_kernel(
      plan, limits,
      {[plan, limits, &widest, threads] { return make_list_kernel(plan, limits, widest, threads); },
       [plan, limits, &widest] { return make_all_pairs_kernel(plan, limits, widest); }});
}

}  // namespace twincell::sim
