#pragma once
/// \file
/// Collects the beds that many threads want to advance, and advances them together.

#include <condition_variable>
#include <cstddef>
#include <exception>
#include <memory>
#include <mutex>
#include <vector>

#include "sim/device/executor.hpp"

namespace twincell::sim {

/// While as many launches are in progress as the executor allows, the beds that arrive wait; the next launch
/// takes those that wait, as many as it may have. No bed waits for another that has not arrived, so threads
/// that do something else delay nobody.
class Batcher {
 public:
  explicit Batcher(std::unique_ptr<Executor> executor) : executor_(std::move(executor)) {}

  [[nodiscard]] Executor& executor() { return *executor_; }
  /// Advances a bed, with all that wait for the same kernel. Returns when it has been advanced.
  /// \throws what the executor throws, in each of the threads concerned
  void advance(const DeviceKernel& kernel, const DeviceBed& bed);
  /// Number of beds that wait for the next launch.
  [[nodiscard]] std::size_t waiting();

 private:
  struct Request {
    const DeviceKernel* kernel;
    const DeviceBed* bed;
    bool done = false;
    std::vector<Request*> batch = {};  ///< which its thread launches; itself among them
    std::exception_ptr error = {};
    std::condition_variable changed = {};  ///< of its own: a launch wakes no thread that has to wait on
  };
  std::vector<Request*> take();
  void launch(const std::vector<Request*>& requests);

  std::unique_ptr<Executor> executor_;
  std::mutex mutex_;  ///< guards the members below
  std::vector<Request*> waiting_;
  int launches_ = 0;  ///< in progress
};

/// The batchers of this process.
/// \throws ConfigError if the program has no device code, or the machine no graphics card that it can use
Batcher& gpu_batcher();
/// The batcher of this process that runs beds on the processor.
Batcher& host_batcher();

}  // namespace twincell::sim
