#pragma once
/// \file
/// A machine that runs device kernels: its memory, and launches.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/device/bed.hpp"
#include "sim/device/device_kernel.hpp"

namespace twincell::sim {

/// All functions may be called from any thread. A failure of the machine is an Error, not the RunError of
/// a bed: it says nothing about the scene.
class Executor {
 public:
  virtual ~Executor() = default;
  /// Memory of the machine, aligned to 64 bytes.
  /// \throws Error if there is not enough
  [[nodiscard]] virtual std::byte* allocate(std::size_t bytes) = 0;
  /// Returns memory of allocate().
  virtual void release(std::byte* memory) = 0;
  /// Copies to device memory.
  virtual void write(std::byte* to, const void* from, std::size_t bytes) = 0;
  /// Copies from device memory.
  virtual void read(void* to, const std::byte* from, std::size_t bytes) = 0;
  /// Number of threads that may be in advance() at once.
  [[nodiscard]] virtual int launches_at_once() const { return 1; }
  /// Number of beds of a launch at most.
  [[nodiscard]] virtual std::size_t beds_per_launch() const { return SIZE_MAX; }
  /// Advances each bed, in one launch. Its inputs and states are in memory of the processor, all other
  /// pointers are into memory of the machine.
  virtual void advance(const DeviceKernel& kernel, const std::vector<DeviceBed>& beds) = 0;
  /// "one thread a bed, on the processor", for example.
  [[nodiscard]] virtual std::string description() const = 0;
};

/// Division of the work of a bed among the threads that the processor imitates. The bits do not depend on it.
struct HostThreads {
  int count = 1;
  bool backwards = false;  ///< the last thread goes first
};

/// Runs a device kernel on the processor.
void run_on_host(const DeviceKernel& kernel, const DeviceBed& bed, const HostThreads& threads = {});

/// Runs the device kernels on the processor, one bed after the other.
std::unique_ptr<Executor> make_host_executor(const HostThreads& threads = {});

}  // namespace twincell::sim
