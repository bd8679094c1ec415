#pragma once
/// \file
/// A machine that runs device kernels: its memory, and launches.

#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "sim/device/bed.hpp"
#include "sim/device/device_kernel.hpp"

namespace twincell::sim {

/// All functions may be called from any thread; advance() by one thread at a time. A failure of the machine
/// is an Error, not the RunError of a bed: it says nothing about the scene.
class Executor {
 public:
  virtual ~Executor() = default;
  /// Memory of the machine, aligned to 64 bytes. \throws Error if there is not enough
  [[nodiscard]] virtual std::byte* allocate(std::size_t bytes) = 0;
  virtual void release(std::byte* memory) = 0;
  virtual void write(std::byte* to, const void* from, std::size_t bytes) = 0;
  virtual void read(void* to, const std::byte* from, std::size_t bytes) = 0;
  /// Advances each bed, in one launch. Pointers in the beds are into memory of the machine.
  virtual void advance(const DeviceKernel& kernel, const std::vector<DeviceBed>& beds) = 0;
  /// "one thread a bed, on the processor", for example.
  [[nodiscard]] virtual std::string description() const = 0;
};

/// Division of the work of a bed among the threads that the processor imitates. The bits do not depend on it.
struct HostThreads {
  int count = 1;
  bool backwards = false;  ///< the last thread goes first
};

/// Runs the device kernels on the processor, one bed after the other.
std::unique_ptr<Executor> make_host_executor(const HostThreads& threads = {});

}  // namespace twincell::sim
