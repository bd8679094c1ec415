// Kernels for any processor, one contact at a time, those in 2D.

#include "sim/contact/collocation_body.hpp"
#include "sim/kernels/simd_kernels.hpp"
#include "sim/kernels/simd_scalar.hpp"

namespace twincell::sim {

extern template Kernels KernelTable<ScalarLanes>::find_in<3>(const KernelKey&);  // kernels_scalar_3d.cpp

const Target kScalar = {"scalar", 1, [] { return true; }, &KernelTable<ScalarLanes>::find,
                        &CollocationTable<ScalarLanes>::find};

}  // namespace twincell::sim
