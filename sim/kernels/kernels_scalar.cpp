// The passes, one contact at a time, for any processor.

#include "sim/contact/collocation_body.hpp"
#include "sim/kernels/simd_kernels.hpp"
#include "sim/kernels/simd_scalar.hpp"

namespace twincell::sim {

const Target kScalar = {"scalar", 1, [] { return true; }, &KernelTable<ScalarLanes>::find,
                        &CollocationTable<ScalarLanes>::find};

}  // namespace twincell::sim
