#pragma once
/// \file
/// Oblique impacts with friction that remembers: what a time step makes of them, against their exact outcome
/// (collision_with_memory.hpp).

#include <string>
#include <vector>

#include "sim/event_driven/collision_with_memory.hpp"
#include "sim/scene/scene.hpp"
#include "sim/scene/step_setting.hpp"

namespace twincell::sim {

/// Two equal beads, or a bead and the resting plate, at first touch. Speeds in sqrt(g sigma).
struct Impact {
  bool wall = false;
  double v_n = 1;  ///< > 0: the speed at which they approach
  double v_t = 0;  ///< of the centres, along the tangent
  double rim = 0;  ///< R_i w_i + R_j w_j, counter-clockwise; R w at the plate
  /// Of the surfaces against each other, at first touch.
  [[nodiscard]] double speed() const;
  /// \param degrees from the normal, without spin
  static Impact at(double degrees, bool wall, double speed = 1, double rim = 0);
};

/// What an impact leaves behind, in the frame of the normal as it is at the end.
struct Outcome {
  double v_n = 0;       ///< away from each other
  double v_t = 0;       ///< of the centres
  double spin = 0;      ///< w', of the bead, or the mean of the two; sqrt(g/sigma)
  double duration = 0;  ///< t0; 0 where it is not known
};

/// A scene in which beads meet and nothing else acts: that of the first paper, with `contact` (lines of
/// [contact]) on top of its contact, in 2D or 3D.
Scene impact_scene(const std::string& contact = "", int dimension = 2);

/// The exact outcome of each impact between the usual beads of a scene, or with its floor, to 1e-9 of the
/// speed (integrate_collision_with_memory, or integrate_collision() for friction without memory).
/// \throws RunError if beads do not part within 20 contact times, or the laws cannot be solved alone
std::vector<Outcome> exact_outcomes(const std::vector<Impact>& impacts, const Scene& scene);
/// The same by another reading of the slip rule, for friction that remembers.
std::vector<Outcome> exact_outcomes(const std::vector<Impact>& impacts, const Scene& scene,
                                    SlipReading reading);

/// The outcome by steps, for each of `phases` entry phases: where within a step the contact begins. Of
/// the integrator and n of `setting` count. \return [impact][phase]
std::vector<std::vector<Outcome>> outcomes_by_steps(const std::vector<Impact>& impacts, Scene scene,
                                                    const StepSetting& setting, int phases);

/// Errors over impacts and phases, of e = v_n'/v_n, of v_t' and of R w', the last two over the speed of the
/// surfaces at first touch.
struct ImpactErrors {
  PhaseSpread restitution, tangential, spin;
  double spin_change = 0;  ///< rms of R (w' - w) over the same speed: what the error of the spin compares to
};
ImpactErrors impact_errors(const std::vector<Impact>& impacts, const std::vector<Outcome>& exact,
                           const Scene& scene, const StepSetting& setting, int phases);
ImpactErrors impact_errors(const std::vector<Impact>& impacts, const Scene& scene, const StepSetting& setting,
                           int phases);

/// Steps per contact that two integrators need for one accuracy.
struct EqualImpacts {
  StepSetting slow, fast;
  ImpactErrors slow_errors, fast_errors;
};
/// The fewest steps (to 2 %) in which `slow` has an rms error of the spin of `share` of its change, and the
/// fewest in which `fast` is no worse than that in the rms of e, v_t' and w'.
EqualImpacts equal_impacts(const std::vector<Impact>& impacts, const Scene& scene, const std::string& slow,
                           const std::string& fast, double share, int phases);

/// First touches in the first paper's bed (crystal, N = 400) in the third period at Gamma, drawn at random
/// from all whose surfaces meet faster than 0.01: what a driven bed's impacts are like. The same for every
/// call.
std::vector<Impact> impacts_of_a_bed(double gamma, int count);

}  // namespace twincell::sim
