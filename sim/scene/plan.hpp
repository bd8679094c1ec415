#pragma once
/// \file
/// From a scene to what must be computed: laws with their parameters, effects on and off with reasons, the
/// time step.

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "sim/kernels/kernels.hpp"
#include "sim/laws/contact_laws.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::sim {

/// One effect and why it is on or off.
struct Effect {
  enum class State {
    on,            ///< the scene says so
    off_by_scene,  ///< the scene says so
    off_by_proof,  ///< it provably cannot act
    approximated,  ///< asked for, with a stated error
  };
  std::string name;
  State state;
  std::string reason;
};
/// "on", "off (scene)", "off (proven)", "approximated".
std::string word_of(Effect::State state);

/// The effect that stands for the step and its integrator.
inline constexpr const char* kTimeIntegration = "time integration";

/// One limit of the time step.
struct TimeLimit {
  std::string name;
  double time;  ///< t0; the step is at most this divided by steps_per_contact
};

/// Overlap, in diameters of the usual (median) bead, at which a run is stopped unless the scene says
/// otherwise. The papers' runs stay below 0.03.
inline constexpr double kOverlapBound = 0.1;
/// Way, in diameters of the smallest bead, that a bead or the plate may go in a step: faster ones could pass
/// through beads.
inline constexpr double kTravelBound = 0.05;

struct Plan {
  int dimension = 2;
  ContactLaws bead;
  std::vector<Wall> walls;             ///< of the cell
  std::vector<ContactLaws> wall_laws;  ///< of each wall
  KernelKey key{};                     ///< which kernel
  bool locate = false;                 ///< moments of entry and exit are located within their steps
  bool rotation = false, history = false;
  bool event_driven =
      false;  ///< beads fly from contact to contact where that is exact (event_driven_solver.hpp)
  double usual_radius = 0.5, usual_mass = 1;  ///< of the median bead
  double largest_force =
      0;  ///< m g, that an overlap at the guard's bound makes: sets the grain of summed forces

  std::vector<Effect> effects;
  std::vector<TimeLimit> limits;         ///< of the bead that makes each shortest
  std::vector<std::string> warnings;     ///< sentences: what runs, but perhaps not as it was meant
  std::int64_t steps_per_period = 0;     ///< a whole number, so that frames fall exactly on phases
  double dt = 0;                         ///< T/steps_per_period
  std::int64_t cycles_before = 0;        ///< run before recording: ramp or schedule, then what is discarded
  std::int64_t steps = 0;                ///< of the drive, recorded or not
  double overlap_bound = kOverlapBound;  ///< sigma
  double travel_bound = kTravelBound;    ///< sigma a step

  /// The chosen laws in one line.
  [[nodiscard]] std::string law_names() const;
  /// The limit that sets the step.
  [[nodiscard]] const TimeLimit& shortest() const;
};

/// Derives the plan. mu = 0 turns friction, rotation and history off, since nothing of them can then act.
/// \param beads whose sizes and masses set the step and the bounds; without any, those that the scene speaks
/// of \throws ConfigError for parameters that a law needs or refuses, for steps too long or too many, and for
/// an effect that the scene would drop although it acts
Plan make_plan(const Scene& scene, const std::vector<Bead>& beads = {});

/// Length of ContactMemory::values under a plan: those of its laws, and what its integrator keeps as well.
std::size_t remembered_numbers(const Plan& plan);

/// The system of a scene, without beads: cell, walls, gravity, drive, clock.
System make_system(const Scene& scene, const Plan& plan);

/// The constants of one kind of contact, in the order of Layout (contact.hpp).
/// \param inv_radius_j 0 at a wall
std::vector<double> contact_constants(const ContactLaws& laws, const PairScale& pair, double reach,
                                      double inv_radius_i, double inv_radius_j);

}  // namespace twincell::sim
