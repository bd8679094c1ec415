// Kernels for any processor in 3D.

#include "sim/kernels/simd_kernels.hpp"
#include "sim/kernels/simd_scalar.hpp"

namespace twincell::sim {

template Kernels KernelTable<ScalarLanes>::find_in<3>(const KernelKey&);

}  // namespace twincell::sim
