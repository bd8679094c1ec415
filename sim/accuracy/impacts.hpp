#pragma once
/// \file
/// Oblique impacts with friction: results of a time step compared with the exact outcome
/// (collision_with_memory.hpp, binary_collision.hpp).

#include <string>
#include <vector>

#include "sim/accuracy/entry_phase_spread.hpp"
#include "sim/accuracy/step_setting.hpp"
#include "sim/event_driven/collision_with_memory.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::sim {

/// Distance between impacts that are simulated side by side, sigma.
inline constexpr double kImpactDistance = 4;

/// Initial data of an impact of two equal beads, or of a bead and the plate at rest, at first touch. Speeds
/// in sqrt(g sigma).
struct Impact {
  bool wall = false;
  double v_n = 1;  ///< > 0: normal speed of approach
  double v_t = 0;  ///< tangential velocity of the centres
  double rim = 0;  ///< R_i w_i + R_j w_j, counter-clockwise; at the plate, R w
  /// Relative speed of the surfaces at first touch, sqrt(g sigma).
  [[nodiscard]] double speed() const;
  /// An impact at an angle.
  /// \param degrees from the normal, without spin
  /// \param speed of the centres
  /// \param rim as the member
  static Impact at(double degrees, bool wall, double speed = 1, double rim = 0);
};

/// Outcome of an impact, relative to the normal at the end of the contact.
struct Outcome {
  double v_n = 0;       ///< normal speed of separation
  double v_t = 0;       ///< tangential velocity of the centres
  double spin = 0;      ///< w' of the bead, or the mean of the two beads; sqrt(g/sigma)
  double duration = 0;  ///< t0; 0 if it is not known
};

/// A scene for isolated impacts, without other forces: the scene of the first paper in 2D or 3D, whose
/// contact is overridden by `contact` (lines of [contact]).
Scene impact_scene(const std::string& contact = "", int dimension = 2);

/// The exact outcome of each impact between two beads of median radius of a scene, or with its floor, to 1e-9
/// of the speed (integrate_collision_with_memory(), or integrate_collision() for friction without history).
/// \throws RunError if beads do not part within 20 contact times, or if the laws cannot be integrated
/// separately
std::vector<Outcome> exact_outcomes(const std::vector<Impact>& impacts, const Scene& scene);
/// The same with another reading of the slip rule, for friction with history.
std::vector<Outcome> exact_outcomes(const std::vector<Impact>& impacts, const Scene& scene,
                                    SlipReading reading);

/// The outcomes with time steps, for `phases` evenly spaced entry phases (the instant within a step at which
/// the contact begins). Only the integrator and n of `setting` are used.
/// \return [impact][phase]
std::vector<std::vector<Outcome>> outcomes_by_steps(const std::vector<Impact>& impacts, Scene scene,
                                                    const StepSetting& setting, int phases);

/// Errors over impacts and phases, of e = v_n'/v_n, of v_t' and of R w', the last two relative to the speed
/// of the surfaces at first touch.
struct ImpactErrors {
  EntryPhaseSpread restitution, tangential, spin;
  double spin_change = 0;  ///< rms of R (w' - w) over the same speed: the scale of the spin error
};
/// Errors of the impacts with the integrator and n of `setting`, at `phases` entry phases.
/// \param exact exact_outcomes() of the impacts in this scene
ImpactErrors impact_errors(const std::vector<Impact>& impacts, const std::vector<Outcome>& exact,
                           const Scene& scene, const StepSetting& setting, int phases);
/// The same; computes the exact outcomes.
/// \throws RunError as exact_outcomes
ImpactErrors impact_errors(const std::vector<Impact>& impacts, const Scene& scene, const StepSetting& setting,
                           int phases);

/// Steps per contact that two integrators need for the same accuracy.
struct EqualImpacts {
  StepSetting slow, fast;
  ImpactErrors slow_errors, fast_errors;
};
/// The fewest steps (to 2 %) with which the rms spin error of `slow` is the fraction `share` of the spin
/// change, and the fewest with which the rms errors of `fast` in e, v_t' and w' are no larger than those of
/// `slow`.
/// \throws RunError if an integrator does not reach the accuracy
EqualImpacts equal_impacts(const std::vector<Impact>& impacts, const Scene& scene, const std::string& slow,
                           const std::string& fast, double share, int phases);

/// Impacts in the driven bed of the first paper (crystal, N = 400): first touches in the third period at
/// Gamma, drawn at random from all whose surfaces meet faster than 0.01. Every call gives the same impacts.
std::vector<Impact> impacts_of_a_bed(double gamma, int count);

}  // namespace twincell::sim
