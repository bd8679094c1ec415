#pragma once
/// \file
/// The kernels that exist for beds on a device.

#include <optional>
#include <string>

#include "sim/kernels/kernels.hpp"

namespace twincell::sim {

/// One device kernel: its index, and its name in the device code.
struct DeviceKernel {
  int index;
  std::string name;
};

/// The kernel of a set of laws; empty if it is not compiled for devices.
std::optional<DeviceKernel> find_device_kernel(const KernelKey& key);

/// The combinations of laws that have a kernel, for messages: "linear + spring, hertz + mindlin, ...".
std::string device_law_words();

}  // namespace twincell::sim
