#include "core/cancellation.hpp"

#include "core/error.hpp"

namespace twincell {

namespace stop_detail {

std::atomic<int> asked_by{0};
std::atomic<int> finishing{0};

void stop() {
  throw Interrupted(static_cast<ExitCode>(128 + cancellation_requested()));
}

}  // namespace stop_detail

bool request_cancellation(int signal) noexcept {
  int none = 0;
  return stop_detail::asked_by.compare_exchange_strong(none, signal);
}

}  // namespace twincell
