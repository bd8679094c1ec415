// Kernels for AVX2. CMake enables AVX2 for this file only.

#include "sim/contact/collocation_body.hpp"
#include "sim/kernels/simd_highway.hpp"
#include "sim/kernels/simd_kernels.hpp"

static_assert(HWY_TARGET == HWY_AVX2, "compile this file for AVX2");

namespace twincell::sim {

const Target kAvx2 = {
    "AVX2", HWY_NAMESPACE::HighwayLanes::kWidth, [] { return (hwy::SupportedTargets() & HWY_AVX2) != 0; },
    &KernelTable<HWY_NAMESPACE::HighwayLanes>::find, &CollocationTable<HWY_NAMESPACE::HighwayLanes>::find};

}  // namespace twincell::sim
