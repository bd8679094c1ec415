#include "sim/device/batcher.hpp"

#include <map>
#include <utility>

#include "sim/device/cuda_executor.hpp"

namespace twincell::sim {

void Batcher::advance(const DeviceKernel& kernel, const DeviceBed& bed) {
  Request own{&kernel, &bed};
  std::unique_lock lock(mutex_);
  waiting_.push_back(&own);
  changed_.wait(lock, [&] { return own.done || !launching_; });
  if (!own.done) {  // this thread launches for all that wait
    launching_ = true;
    const std::vector<Request*> requests = std::exchange(waiting_, {});
    lock.unlock();
    launch(requests);
    lock.lock();
    for (Request* request : requests) request->done = true;
    launching_ = false;
    changed_.notify_all();
  }
  if (own.error) std::rethrow_exception(own.error);
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
