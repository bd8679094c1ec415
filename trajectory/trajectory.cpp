#include "trajectory/trajectory.hpp"

#include <algorithm>

namespace twincell {

std::size_t Frame::n_present() const {
  if (id.empty()) return position.size();
  return static_cast<std::size_t>(std::count_if(id.begin(), id.end(), [](std::int64_t v) { return v >= 0; }));
}

}  // namespace twincell
