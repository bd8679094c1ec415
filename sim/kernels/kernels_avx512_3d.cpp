// Kernels for AVX-512 in 3D.

#include "sim/kernels/simd_highway.hpp"
#include "sim/kernels/simd_kernels.hpp"

static_assert(HWY_TARGET == HWY_AVX3, "compile this file for AVX-512");

namespace twincell::sim {

template Kernels KernelTable<HWY_NAMESPACE::HighwayLanes>::find_in<3>(const KernelKey&);

}  // namespace twincell::sim
