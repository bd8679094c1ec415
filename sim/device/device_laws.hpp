#pragma once
/// \file
/// The combinations of contact laws for which the device kernel is compiled: the only list of them. To add
/// one, add a line. A law whose force needs more than the operations of laws/scalar_arithmetic.hpp, such as
/// the logarithm of "velocity-dependent-restitution", cannot be added. Each line costs four kernels, about a
/// second of compiling.

#include "sim/contact/contact.hpp"

/// X(name of the kernel, normal law, tangential law)
#define TWINCELL_DEVICE_LAWS(X)                               \
  X(linear_none, LinearSpringDashpot, NoTangential)           \
  X(linear_dashpot, LinearSpringDashpot, DashpotSlider)       \
  X(linear_spring, LinearSpringDashpot, SpringSlider)         \
  X(linear_limited, LinearSpringDashpot, SpringLimitedSlider) \
  X(no_tension_none, NoTensionSpringDashpot, NoTangential)    \
  X(no_tension_spring, NoTensionSpringDashpot, SpringSlider)  \
  X(hertz_none, HertzViscoelastic, NoTangential)              \
  X(hertz_mindlin, HertzViscoelastic, MindlinSlider)

namespace twincell::sim {

/// Index of each combination, and their number. Each has four kernels: in 2D and 3D, with velocities at half
/// and full steps.
struct DeviceLawSet {
  enum Index : int {
#define TWINCELL_INDEX(name, normal, tangential) name,
    TWINCELL_DEVICE_LAWS(TWINCELL_INDEX)
#undef TWINCELL_INDEX
        kCount
  };
};

}  // namespace twincell::sim
