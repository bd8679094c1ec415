#pragma once
/// \file
/// The integrators: one table that the scene reader, the plan, the LAMMPS export and the studies of accuracy
/// share.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/choice.hpp"
#include "sim/contact/velocity.hpp"

namespace twincell::sim {

/// An integrator: how a time step advances a contact.
struct Integrator {
  std::string_view word;     ///< time.integrator
  std::string_view explain;  ///< description in one clause
  Velocity velocity;         ///< velocity that the laws use
  bool locate;               ///< first and last touch are located within their steps
  double steps_per_contact;  ///< default n of scenes that do not set it
  bool lammps;               ///< LAMMPS has the same integrator
};

/// All integrators. The first is the default: for every contact law it is on the Pareto front of accuracy
/// against time (`cost sim`; docs/accuracy.md, "Defaults"). Its n is the smallest of those that `cost sim`
/// measures with which, for every law, the impacts of a bed have an rms error of v_t' and R w' within 1 % of
/// the change by friction, and of e within 0.002. The n of the others is customary in LAMMPS and similar
/// programs.
inline constexpr std::array kAllIntegrators = {
    Integrator{"split", "split at entry and exit", Velocity::full_step, true, 20, false},
    Integrator{"verlet", "dashpots lag by half a step", Velocity::half_step, false, 50, true},
    Integrator{"predicted", "velocities predicted for the end of a step", Velocity::full_step, false, 50,
               false}};

inline constexpr const Integrator& kDefaultIntegrator = kAllIntegrators.front();

/// The words of all integrators, for messages.
std::vector<std::string> integrator_words();
/// Integrator with this word.
/// \throws ConfigError naming the valid words if there is none
const Integrator& integrator_named(const std::string& word);

/// time.stepping: how time is advanced.
enum class Stepping { automatic, steps, event_driven };
inline constexpr std::array kSteppings = {
    Choice<Stepping>{Stepping::automatic, "auto",
                     "event-driven where this is exact and faster, otherwise steps"},
    Choice<Stepping>{Stepping::steps, "steps", "one time step for all beads"},
    Choice<Stepping>{Stepping::event_driven, "event-driven", "ballistic paths between contacts"}};

}  // namespace twincell::sim
