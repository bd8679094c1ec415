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
  /// Numbers of sorted indices, one set for each of three calls in turn: while a set is in use, another is
  /// still read, and the third is set to 0 for the next call.
  struct Counts {
    SortedCounts of_call[3];
  };
  Counts& counts;
  mutable std::int32_t call = 0;

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
  __device__ SortedCounts sort(std::int32_t count, std::int32_t* list, F f) const {
    const auto threads = static_cast<std::int32_t>(__nvvm_read_ptx_sreg_ntid_x());
    const auto thread = static_cast<std::int32_t>(__nvvm_read_ptx_sreg_tid_x());
    SortedCounts& n = counts.of_call[call];
    call = call == 2 ? 0 : call + 1;
    if (thread == 0) counts.of_call[call] = {0, 0};
    const std::int32_t lane = thread % kWarp;
    for (std::int32_t first = thread - lane; first < count; first += threads) {
      const std::int32_t i = first + lane;
      const Sorted to = i < count ? f(i) : Sorted::out;
      __nvvm_bar_warp_sync(kAll);
      const std::int32_t front = place(to == Sorted::front, lane, n.front);
      const std::int32_t back = place(to == Sorted::back, lane, n.back);
      if (to == Sorted::front) list[front] = i;
      if (to == Sorted::back) list[count - 1 - back] = i;
    }
    __syncthreads();
    return n;
  }
  /// The place of each thread of a warp among those that take one. One of them counts for all.
  static __device__ std::int32_t place(bool takes, std::int32_t lane, std::int32_t& taken) {
    const unsigned takers = __nvvm_vote_ballot_sync(kAll, takes);
    if (takers == 0) return 0;
    std::int32_t begin = 0;
    if (lane == 0) begin = __atomic_fetch_add(&taken, __builtin_popcount(takers), __ATOMIC_RELAXED);
    begin = __nvvm_shfl_sync_idx_i32(kAll, begin, 0, kWarp - 1);
    return begin + __builtin_popcount(takers & ((1u << lane) - 1));
  }
  static constexpr unsigned kAll = 0xffffffff;
  template <class F>
  __device__ void once(F f) const {
    if (__nvvm_read_ptx_sreg_tid_x() == 0) f();
    __syncthreads();
  }
};

__device__ inline BlockSpace own_space() {
  __attribute__((shared)) static BlockSpace::Counts counts;
  const BlockSpace space{counts};
  space.once([&] { counts = {}; });
  return space;
}

/// The bed of this block, in memory of the block.
__device__ inline const DeviceBed& own_bed(const BlockSpace& space, const DeviceBed* beds) {
  __attribute__((shared)) static std::uint64_t words[sizeof(DeviceBed) / 8];
  static_assert(sizeof(DeviceBed) % 8 == 0);
  const auto* from = reinterpret_cast<const std::uint64_t*>(beds + __nvvm_read_ptx_sreg_ctaid_x());
  space.for_each(sizeof(DeviceBed) / 8, [&](std::int32_t k) { words[k] = from[k]; });
  return *reinterpret_cast<const DeviceBed*>(words);
}

#define TWINCELL_JOIN(a, b) a##b
#define TWINCELL_ENTRY(name, suffix) TWINCELL_JOIN(name, suffix)
#define TWINCELL_KERNEL(suffix, dimension, velocity)                                                           \
  extern "C" __attribute__((global)) __attribute__((launch_bounds(kMaxThreads))) void TWINCELL_ENTRY(         \
      TWINCELL_NAME, suffix)(const DeviceBed* beds) {                                                          \
    const BlockSpace space = own_space();                                                                      \
    advance_bed<BlockSpace, LawSet<TWINCELL_NORMAL, TWINCELL_TANGENTIAL, NoRolling>, dimension,                \
                Velocity::velocity>(space, own_bed(space, beds));                                              \
  }
TWINCELL_KERNEL(_2d_half, 2, half_step)
TWINCELL_KERNEL(_2d_full, 2, full_step)
TWINCELL_KERNEL(_3d_half, 3, half_step)
TWINCELL_KERNEL(_3d_full, 3, full_step)

}  // namespace twincell::sim
