#pragma once
/// \file
/// Processor time of the calling thread and of the process.

#include <ctime>

namespace twincell {

namespace cpu_clock_detail {
inline double seconds(clockid_t clock) {
  timespec t{};
  clock_gettime(clock, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}
}  // namespace cpu_clock_detail

/// Processor time of the calling thread since an arbitrary origin, s. Excludes the time of other programs.
inline double thread_cpu_seconds() {
  return cpu_clock_detail::seconds(CLOCK_THREAD_CPUTIME_ID);
}

/// Processor time of all threads of this process since its start, s.
inline double process_cpu_seconds() {
  return cpu_clock_detail::seconds(CLOCK_PROCESS_CPUTIME_ID);
}

}  // namespace twincell
