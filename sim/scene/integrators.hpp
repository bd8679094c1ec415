#pragma once
/// \file
/// The integrators of time steps: one table that the scene's reader, the plan, the LAMMPS export and the
/// studies of accuracy share.

#include <array>
#include <string>
#include <string_view>
#include <vector>

#include "core/choice.hpp"
#include "sim/contact/contact.hpp"

namespace twincell::sim {

/// How a contact is advanced by a step.
struct Integrator {
  std::string_view word;     ///< time.integrator
  std::string_view explain;  ///< in one clause
  Velocity velocity;         ///< which velocity the laws see
  bool locate;               ///< first and last touch are located within their steps
  double steps_per_contact;  ///< of a scene that does not state n
  bool lammps;               ///< LAMMPS computes the same
};

/// All of them; the first is that of a scene that states none: on the front of accuracy against time (`cost
/// sim`), for every contact law (docs/accuracy.md, "Defaults"). Its n is the fewest, of those that `cost sim`
/// measures, by which the impacts of a bed leave with v_t' and R w' right to 1 % of what friction changes and
/// e to 0.002, rms, whatever the law; that of the others is what LAMMPS and its kin take.
inline constexpr std::array kAllIntegrators = {
    Integrator{"split", "split at entry and exit", Velocity::full_step, true, 20, false},
    Integrator{"verlet", "dashpots half a step late", Velocity::half_step, false, 50, true},
    Integrator{"predicted", "velocities predicted for a step's end", Velocity::full_step, false, 50, false}};

inline constexpr const Integrator& kDefaultIntegrator = kAllIntegrators.front();

std::vector<std::string> integrator_words();
/// \throws ConfigError naming the words if there is none of that name
const Integrator& integrator_named(const std::string& word);

/// time.stepping: how time is advanced.
enum class Stepping { automatic, steps, event_driven };
inline constexpr std::array kSteppings = {
    Choice<Stepping>{Stepping::automatic, "auto"},  // event-driven where that is exact and faster
    Choice<Stepping>{Stepping::steps, "steps"}, Choice<Stepping>{Stepping::event_driven, "event-driven"}};

}  // namespace twincell::sim
