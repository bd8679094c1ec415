#include "sim/kernels/kernels.hpp"

namespace twincell::sim {

const Target& widest_target() {
  static const Target& widest = kAvx512.available() ? kAvx512 : kAvx2.available() ? kAvx2 : kScalar;
  return widest;
}

}  // namespace twincell::sim
