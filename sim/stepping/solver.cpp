#include "sim/stepping/solver.hpp"

#include <algorithm>
#include <thread>

namespace twincell::sim {

int threads_for(std::size_t beads, int asked) {
  constexpr std::size_t kBeadsPerThread =
      8192;  // with fewer beads, two barriers per step cost more than a thread saves
  const std::size_t most = asked > 0 ? beads : beads / kBeadsPerThread;
  const std::size_t wanted =
      asked > 0 ? static_cast<std::size_t>(asked) : std::max(1U, std::thread::hardware_concurrency());
  return static_cast<int>(std::clamp<std::size_t>(wanted, 1, std::max<std::size_t>(1, most)));
}

}  // namespace twincell::sim
