// The passes, one contact at a time, for any processor.

#include "sim/collocation_body.hpp"
#include "sim/lanes_scalar.hpp"
#include "sim/passes_body.hpp"

namespace twincell::sim {

const Target kScalar = {"scalar", 1, [] { return true; },
                        [](const PassKey& key) {
                          return key.single ? PassTable<ScalarLanes<float>>::find(key)
                                            : PassTable<ScalarLanes<double>>::find(key);
                        },
                        &CollocationTable<ScalarLanes<double>>::find};

}  // namespace twincell::sim
