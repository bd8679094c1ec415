#include "sim/kernels/kernels.hpp"

namespace twincell::sim {

const Target& widest_target() {
#ifdef __SANITIZE_THREAD__
  return kScalar;  // the only kernels that are compiled with sanitizers (CMakeLists.txt)
#endif
  static const Target& widest = kAvx512.available() ? kAvx512 : kAvx2.available() ? kAvx2 : kScalar;
  return widest;
}

}  // namespace twincell::sim
