#pragma once
/// \file
/// Whether the stated strengths of several stacks belong to them.

#include <string>
#include <vector>

namespace twincell::twin {

/// How one of several stacks was driven.
struct StackDrive {
  std::string name;      ///< of the stack
  double gamma = 0;      ///< A omega^2/g as stated; 0: not stated
  double amplitude = 0;  ///< A, sigma, as measured on the plate or stated; 0: unknown
  int frames_per_cycle = 0;
};

/// A sentence if two stacks with as many frames per cycle differ by more than 8 % in Gamma/A = omega^2/g,
/// which is the same at one frequency; it names the order of the strengths that agrees with the amplitudes,
/// if there is one. Empty otherwise.
std::string strengths_doubt(const std::vector<StackDrive>& drives);

}  // namespace twincell::twin
