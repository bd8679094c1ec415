#include "sim/device/batcher.hpp"

#include <algorithm>
#include <map>

#include "sim/device/cuda_executor.hpp"

namespace twincell::sim {

void Batcher::advance(const DeviceKernel& kernel, const DeviceBed& bed) {
  Request own{.kernel = &kernel, .bed = &bed};
  std::unique_lock lock(mutex_);
  waiting_.push_back(&own);
  if (launches_ < executor_->launches_at_once()) {
    ++launches_;
    own.batch = take();
  } else {
    own.changed.wait(lock, [&] { return own.done || !own.batch.empty(); });
  }
  if (!own.batch.empty()) {
    lock.unlock();
    launch(own.batch);
    lock.lock();
    for (Request* request : own.batch) {
      request->done = true;
      if (request != &own) request->changed.notify_one();
    }
    if (waiting_.empty()) {
      --launches_;
    } else {  // one of those that wait launches them
      Request* next = waiting_.front();
      next->batch = take();
      next->changed.notify_one();
    }
  }
  if (own.error) std::rethrow_exception(own.error);
}

/// The first of those that wait, as many as a launch may have.
std::vector<Batcher::Request*> Batcher::take() {
  const auto count = static_cast<std::ptrdiff_t>(std::min(waiting_.size(), executor_->beds_per_launch()));
  std::vector<Request*> batch(waiting_.begin(), waiting_.begin() + count);
  waiting_.erase(waiting_.begin(), waiting_.begin() + count);
  return batch;
}

std::size_t Batcher::waiting() {
  const std::lock_guard lock(mutex_);
  return waiting_.size();
}

/// One launch for each kernel.
void Batcher::launch(const std::vector<Request*>& requests) {
  std::map<int, std::vector<Request*>> by_kernel;
  for (Request* request : requests) by_kernel[request->kernel->index].push_back(request);
  for (const auto& [index, group] : by_kernel) {
    try {
      std::vector<DeviceBed> beds;
      for (const Request* request : group) beds.push_back(*request->bed);
      executor_->advance(*group.front()->kernel, beds);
    } catch (...) {
      for (Request* request : group) request->error = std::current_exception();
    }
  }
}

Batcher& gpu_batcher() {
  static Batcher batcher(make_cuda_executor());
  return batcher;
}

Batcher& host_batcher() {
  static Batcher batcher(make_host_executor());
  return batcher;
}

}  // namespace twincell::sim
