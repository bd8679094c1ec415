#pragma once
/// \file
/// The graphics card of this machine, through the driver of CUDA, which is loaded when it is asked for:
/// neither building nor starting the program needs it.

#include <memory>

#include "sim/device/executor.hpp"

namespace twincell::sim {

/// Opens the first card.
/// \throws ConfigError if the program contains no device code, or there is no driver or no card
std::unique_ptr<Executor> make_cuda_executor();

}  // namespace twincell::sim
