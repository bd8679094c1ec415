#include "analysis/trajectory/stop.hpp"

#include "analysis/trajectory/error.hpp"

namespace twincell {

namespace stop_detail {

std::atomic<int> asked_by{0};
std::atomic<int> finishing{0};

void stop() {
  throw Interrupted(static_cast<ExitCode>(128 + asked_to_stop()));
}

}  // namespace stop_detail

bool ask_to_stop(int signal) noexcept {
  int none = 0;
  return stop_detail::asked_by.compare_exchange_strong(none, signal);
}

}  // namespace twincell
