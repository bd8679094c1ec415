#pragma once
/// \file
/// Runs independent jobs on several threads.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "core/cancellation.hpp"

namespace twincell {

/// Calls work(i) once for each i = 0 .. n - 1, in this order, on `threads` threads including the caller's.
/// Returns when all jobs have ended.
///
/// After a job throws, no further job starts. When the running jobs have ended, the exception of the smallest
/// i is rethrown, which is the same for any number of threads. A cancellation request (cancellation.hpp) acts
/// as an exception of the next job.
/// \param threads values below 1 count as 1
template <class Work>
void in_parallel(std::size_t n, int threads, const Work& work) {
  std::atomic<std::size_t> next{0};
  std::mutex mutex;
  std::exception_ptr failure;
  std::size_t failed = n;
  const auto take_jobs = [&] {
    for (std::size_t i = next++; i < n; i = next++) try {
        throw_if_cancelled();
        work(i);
      } catch (...) {
        const std::scoped_lock lock(mutex);
        if (i < failed) failed = i, failure = std::current_exception();
        next = n;
      }
  };
  {
    std::vector<std::jthread> others;
    const std::size_t wanted = std::min(static_cast<std::size_t>(std::max(threads, 1)), n);
    for (std::size_t t = 1; t < wanted; ++t) others.emplace_back(take_jobs);
    take_jobs();
  }
  if (failure) std::rethrow_exception(failure);
}

}  // namespace twincell
