#pragma once
/// \file
/// Processor time of the calling thread and of the process.

#include <ctime>

namespace twincell {

/// Processor time of the calling thread since an arbitrary origin, s. Excludes the time of other programs.
inline double cpu_seconds() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

/// Processor time of all threads of this process since its start, s.
inline double processor_seconds() {
  timespec t{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

}  // namespace twincell
