#pragma once
/// \file
/// The request, by a signal, that the process stop, and how work of any depth learns of it.
///
/// A function that has a Progress (progress.hpp) asks that. What lies deeper, or runs before there is one,
/// calls throw_if_cancelled between pieces of work that take up to a tenth of a second.

#include <atomic>

namespace twincell {

namespace stop_detail {
extern std::atomic<int> asked_by;   ///< number of the signal; 0: none came
extern std::atomic<int> finishing;  ///< FinishFirst objects that live
[[noreturn]] void stop();
}  // namespace stop_detail

/// Notes that a signal asks the process to stop. Async-signal-safe. \returns whether it is the first to ask
bool request_cancellation(int signal) noexcept;

/// The signal that has asked; 0 if none has.
inline int cancellation_requested() noexcept {
  return stop_detail::asked_by.load(std::memory_order_relaxed);
}

/// Whether somebody finishes something first (FinishFirst).
inline bool finishing_first() noexcept {
  return stop_detail::finishing.load(std::memory_order_relaxed) > 0;
}

/// \throws Interrupted if the process has been asked to stop and nobody finishes something first
inline void throw_if_cancelled() {
  if (cancellation_requested() != 0 && !finishing_first()) [[unlikely]]
    stop_detail::stop();
}

/// While one lives throw_if_cancelled does nothing: its holder looks at cancellation_requested itself, when
/// what it works on is in a state that can be saved.
class FinishFirst {
 public:
  FinishFirst() noexcept { ++stop_detail::finishing; }
  FinishFirst(const FinishFirst&) = delete;
  FinishFirst& operator=(const FinishFirst&) = delete;
  ~FinishFirst() { --stop_detail::finishing; }
};

}  // namespace twincell
