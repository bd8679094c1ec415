// The passes, one contact at a time, for any processor.

#include "sim/lanes_scalar.hpp"
#include "sim/passes_body.hpp"

namespace twincell::sim {

const Target kScalar = {"scalar", ScalarLanes::kWidth, [] { return true; },
                        [](const PassKey& key) {
                          return key.dimension == 2 ? PassTable<ScalarLanes>::find<2>(key)
                                                    : PassTable<ScalarLanes>::find<3>(key);
                        }};

}  // namespace twincell::sim
