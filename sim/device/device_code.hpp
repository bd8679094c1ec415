#pragma once
/// \file
/// The device kernels as code for graphics cards, PTX, which the build embeds (cmake/device_code.cmake).

#include <span>

namespace twincell::sim {

/// The text for each combination of laws, in the order of device_laws.hpp; empty if the program was built
/// without device code. The kernels in it have the names of device_kernel.hpp.
std::span<const char* const> device_code();

}  // namespace twincell::sim
