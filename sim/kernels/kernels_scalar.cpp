// The passes, one contact at a time, for any processor.

#include "sim/contact/collocation_body.hpp"
#include "sim/kernels/simd_kernels.hpp"
#include "sim/kernels/simd_scalar.hpp"

namespace twincell::sim {

const Target kScalar = {"scalar", 1, [] { return true; },
                        [](const KernelKey& key) {
                          return key.single ? KernelTable<ScalarLanes<float>>::find(key)
                                            : KernelTable<ScalarLanes<double>>::find(key);
                        },
                        &CollocationTable<ScalarLanes<double>>::find};

}  // namespace twincell::sim
