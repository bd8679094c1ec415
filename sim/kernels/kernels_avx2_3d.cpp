// Kernels for AVX2 in 3D.

#include "sim/kernels/simd_highway.hpp"
#include "sim/kernels/simd_kernels.hpp"

static_assert(HWY_TARGET == HWY_AVX2, "compile this file for AVX2");

namespace twincell::sim {

template Kernels KernelTable<HWY_NAMESPACE::HighwayLanes>::find_in<3>(const KernelKey&);

}  // namespace twincell::sim
