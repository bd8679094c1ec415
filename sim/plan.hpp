#pragma once
/// \file
/// From a scene to what must be computed: laws with their parameters, effects on and off with reasons, the
/// time step.

#include <cstdint>
#include <string>
#include <vector>

#include "sim/laws/axes.hpp"
#include "sim/scene.hpp"

namespace twincell::sim {

/// One effect and why it is on or off.
struct Effect {
  enum class State { on, off_by_scene, off_by_proof };
  std::string name;
  State state;
  std::string reason;
};

/// One limit of the time step.
struct TimeLimit {
  std::string name;
  double time;  ///< t0; the step is at most this divided by steps_per_contact
};

struct Plan {
  struct Contact {
    NormalAxis normal;
    TangentialAxis tangential;
  };
  Contact bead, wall;
  SideAxis side;
  bool rotation = false, history = false;
  double largest_diameter = 1;

  std::vector<Effect> effects;
  std::vector<TimeLimit> limits;
  std::int64_t steps_per_period = 0;  ///< a whole number, so that frames fall exactly on phases
  double dt = 0;                      ///< T/steps_per_period

  /// The chosen laws in one line.
  [[nodiscard]] std::string kernel_name() const;
};

/// Derives the plan. mu = 0 turns friction, rotation and history off, since nothing of them can then act.
Plan make_plan(const Scene& scene);

}  // namespace twincell::sim
