#pragma once
/// \file
/// Time that the calling thread has spent computing.

#include <ctime>

namespace twincell {

/// Seconds of processor time of the calling thread, from an arbitrary beginning: what other programs take of
/// the processor does not count.
inline double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace twincell
