#pragma once
/// \file
/// Cancellation: a signal requests that the process stop, and running work checks for the request.
///
/// A function that has a Progress (progress.hpp) calls Progress::update. Code below it in the call stack, or
/// code that runs before a Progress exists, calls throw_if_cancelled between units of work of up to 0.1 s.

#include <atomic>

namespace twincell {

namespace stop_detail {
extern std::atomic<int> asked_by;   ///< number of the signal; 0: no signal received
extern std::atomic<int> finishing;  ///< number of live FinishFirst objects
/// \throws Interrupted always, with the exit code of the signal
[[noreturn]] void stop();
}  // namespace stop_detail

/// Records that a signal requests the process to stop. Async-signal-safe.
/// \returns whether it is the first one
bool request_cancellation(int signal) noexcept;

/// Forgets the request: for an interpreter, which goes on after it has stopped one computation.
inline void withdraw_cancellation() noexcept {
  stop_detail::asked_by.store(0);
}

/// Number of the first signal that requested cancellation; 0 if there was none.
inline int cancellation_requested() noexcept {
  return stop_detail::asked_by.load(std::memory_order_relaxed);
}

/// Whether a FinishFirst object defers cancellation.
inline bool finishing_first() noexcept {
  return stop_detail::finishing.load(std::memory_order_relaxed) > 0;
}

/// \throws Interrupted if cancellation was requested and no FinishFirst object defers it
inline void throw_if_cancelled() {
  if (cancellation_requested() != 0 && !finishing_first()) [[unlikely]]
    stop_detail::stop();
}

/// Defers cancellation: throw_if_cancelled does nothing during the lifetime of such an object. Its owner
/// checks cancellation_requested itself, at points where the state of its work can be saved.
class FinishFirst {
 public:
  FinishFirst() noexcept { ++stop_detail::finishing; }
  FinishFirst(const FinishFirst&) = delete;
  FinishFirst& operator=(const FinishFirst&) = delete;
  ~FinishFirst() { --stop_detail::finishing; }
};

}  // namespace twincell
