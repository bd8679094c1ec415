// Kernels for AVX-512, those in 2D. CMake enables AVX-512 for kernels_avx512*.cpp only.

#include "sim/contact/collocation_body.hpp"
#include "sim/kernels/simd_highway.hpp"
#include "sim/kernels/simd_kernels.hpp"

static_assert(HWY_TARGET == HWY_AVX3, "compile this file for AVX-512");

namespace twincell::sim {

extern template Kernels KernelTable<HWY_NAMESPACE::HighwayLanes>::find_in<3>(
    const KernelKey&);  // kernels_avx512_3d.cpp

const Target kAvx512 = {
    "AVX-512", HWY_NAMESPACE::HighwayLanes::kWidth, [] { return (hwy::SupportedTargets() & HWY_AVX3) != 0; },
    &KernelTable<HWY_NAMESPACE::HighwayLanes>::find, &CollocationTable<HWY_NAMESPACE::HighwayLanes>::find};

}  // namespace twincell::sim
