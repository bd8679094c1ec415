// Kernels for AVX2, those in 2D. CMake enables AVX2 for kernels_avx2*.cpp only.

#include "sim/contact/collocation_body.hpp"
#include "sim/kernels/simd_highway.hpp"
#include "sim/kernels/simd_kernels.hpp"

static_assert(HWY_TARGET == HWY_AVX2, "compile this file for AVX2");

namespace twincell::sim {

extern template Kernels KernelTable<HWY_NAMESPACE::HighwayLanes>::find_in<3>(
    const KernelKey&);  // kernels_avx2_3d.cpp

const Target kAvx2 = {
    "AVX2", HWY_NAMESPACE::HighwayLanes::kWidth, [] { return (hwy::SupportedTargets() & HWY_AVX2) != 0; },
    &KernelTable<HWY_NAMESPACE::HighwayLanes>::find, &CollocationTable<HWY_NAMESPACE::HighwayLanes>::find};

}  // namespace twincell::sim
