// Kernels for any processor, one contact at a time.

#include "sim/contact/collocation_body.hpp"
#include "sim/kernels/simd_kernels.hpp"
#include "sim/kernels/simd_scalar.hpp"

namespace twincell::sim {

const Target kScalar = {"scalar", 1, [] { return true; }, &KernelTable<ScalarLanes>::find,
                        &CollocationTable<ScalarLanes>::find};

}  // namespace twincell::sim
