// The device kernels of one combination of laws, compiled by clang to PTX without the CUDA toolkit
// (cmake/device_code.cmake). TWINCELL_NAME, TWINCELL_NORMAL and TWINCELL_TANGENTIAL are a row of device_laws.hpp.

#define __host__ __attribute__((host))
#define __device__ __attribute__((device))

// The two functions of the C library that laws use, for the device: correctly rounded instructions. They are declared
// before the headers of the standard library, which then offer them as std::fma and std::sqrt.
static __device__ inline double fma(double a, double b, double c) { return __builtin_fma(a, b, c); }
static __device__ inline double sqrt(double a) { return __builtin_sqrt(a); }

#include <cstdlib>  // before the others, because clang's <new> for devices needs it

#include <algorithm>
#include <array>
#include <cmath>
#include <concepts>
#include <cstdint>

#include <filesystem>
#include <memory>
#include <numbers>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#pragma clang force_cuda_host_device begin
#include "sim/device/advance_bed.hpp"
#pragma clang force_cuda_host_device end

namespace twincell::sim {

/// The threads of a block.
struct BlockSpace {
  template <class F>
  __device__ void for_each(std::int32_t count, F f) const {
    const auto threads = static_cast<std::int32_t>(__nvvm_read_ptx_sreg_ntid_x());
    for (auto i = static_cast<std::int32_t>(__nvvm_read_ptx_sreg_tid_x()); i < count; i += threads) f(i);
    __syncthreads();
  }
  template <class F>
  __device__ bool any(std::int32_t count, F f) const {
    const auto threads = static_cast<std::int32_t>(__nvvm_read_ptx_sreg_ntid_x());
    bool found = false;
    for (auto i = static_cast<std::int32_t>(__nvvm_read_ptx_sreg_tid_x()); i < count; i += threads)
      if (f(i)) found = true;
    return __nvvm_bar0_or(found) != 0;
  }
  template <class F>
  __device__ void once(F f) const {
    if (__nvvm_read_ptx_sreg_tid_x() == 0) f();
    __syncthreads();
  }
};

/// The bed of this block, in memory of the block.
__device__ inline const DeviceBed& own_bed(const DeviceBed* beds) {
  __attribute__((shared)) static std::uint64_t words[sizeof(DeviceBed) / 8];
  static_assert(sizeof(DeviceBed) % 8 == 0);
  const auto* from = reinterpret_cast<const std::uint64_t*>(beds + __nvvm_read_ptx_sreg_ctaid_x());
  BlockSpace{}.for_each(sizeof(DeviceBed) / 8, [&](std::int32_t k) { words[k] = from[k]; });
  return *reinterpret_cast<const DeviceBed*>(words);
}

#define TWINCELL_JOIN(a, b) a##b
#define TWINCELL_ENTRY(name, suffix) TWINCELL_JOIN(name, suffix)
#define TWINCELL_KERNEL(suffix, dimension, velocity)                                                           \
  extern "C" __attribute__((global)) __attribute__((launch_bounds(kMostThreads))) void TWINCELL_ENTRY(         \
      TWINCELL_NAME, suffix)(const DeviceBed* beds) {                                                          \
    advance_bed<BlockSpace, LawSet<TWINCELL_NORMAL, TWINCELL_TANGENTIAL, NoRolling>, dimension,                \
                Velocity::velocity>(BlockSpace{}, own_bed(beds));                                              \
  }
TWINCELL_KERNEL(_2d_half, 2, half_step)
TWINCELL_KERNEL(_2d_full, 2, full_step)
TWINCELL_KERNEL(_3d_half, 3, half_step)
TWINCELL_KERNEL(_3d_full, 3, full_step)

}  // namespace twincell::sim
