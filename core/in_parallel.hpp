#pragma once
/// \file
/// Jobs that do not depend on each other, on several threads.

#include <algorithm>
#include <atomic>
#include <cstddef>
#include <exception>
#include <mutex>
#include <thread>
#include <vector>

#include "core/cancellation.hpp"

namespace twincell {

/// Calls work(i) once for each i = 0 .. n - 1, begun in this order, on so many threads, of which the caller's
/// is one; returns when all have ended.
///
/// After a job has thrown, none begins any more, and once those under way have ended the exception of the
/// smallest i is thrown again: the same one for any number of threads. A signal that asks the process to stop
/// (cancellation.hpp) counts as such an exception of the next job.
/// \param threads fewer than 1 counts as 1
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
