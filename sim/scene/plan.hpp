#pragma once
/// \file
/// The plan of a run: contact laws with their parameters, effects on and off with reasons, and the time step.
/// make_plan.hpp derives it from a scene.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "sim/kernels/kernels.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::sim {

struct CellLaws;
struct ContactLaws;
struct PairScale;

/// A physical effect, and why it is on or off.
struct Effect {
  enum class State {
    on,            ///< the scene includes it
    off_by_scene,  ///< the scene excludes it
    off_by_proof,  ///< it provably has no influence
    approximated,  ///< included with a stated approximation
  };
  std::string name;
  State state;
  std::string reason;
};
/// "on", "off (scene)", "off (proven)", "approximated".
std::string word_of(Effect::State state);

/// Name of the effect that represents the time step and its integrator.
inline constexpr const char* kTimeIntegration = "time integration";

/// One upper limit of the time step.
struct TimeLimit {
  std::string name;
  double time;  ///< t0; the step is at most this divided by steps_per_contact
};

/// Default bound on overlaps, in diameters of the median bead: a deeper overlap stops the run. The papers'
/// runs stay below 0.03.
inline constexpr double kOverlapBound = 0.1;
/// Largest displacement of a bead or the plate in one step, in diameters of the smallest bead. Faster bodies
/// could pass through beads.
inline constexpr double kTravelBound = 0.05;

/// All that a run computes: contact laws, effects, time step and bounds.
struct Plan {
  int dimension = 2;
  std::shared_ptr<const CellLaws> laws;  ///< laws/cell_laws.hpp; not null
  std::vector<Wall> walls;               ///< walls of the cell
  KernelKey key{};                       ///< selects the kernels
  bool locate = false;                   ///< the instants of entry and exit are located within their steps
  bool rotation = false, history = false;
  bool stores_memory = false;  ///< frames contain the memory of their contacts
  bool event_driven =
      false;  ///< event-driven motion between contacts, where it is exact (event_driven_solver.hpp)
  double usual_radius = 0.5, usual_mass = 1;  ///< of the median bead
  double largest_force =
      0;  ///< m g, at an overlap equal to the bound; sets the rounding quantum of force sums

  std::vector<Effect> effects;
  std::vector<TimeLimit> limits;         ///< each for the bead that makes it shortest
  std::vector<std::string> warnings;     ///< sentences about settings that run but may not be intended
  std::int64_t steps_per_period = 0;     ///< an integer, so that frames are exactly at their phases
  double dt = 0;                         ///< T/steps_per_period
  std::int64_t cycles_before = 0;        ///< run before recording: ramp or schedule, then `discard`
  std::int64_t steps = 0;                ///< total steps of the drive, recorded or not
  double overlap_bound = kOverlapBound;  ///< sigma
  double travel_bound = kTravelBound;    ///< sigma per step

  /// The chosen laws in one line.
  [[nodiscard]] std::string law_names() const;
  /// The limit that determines the step.
  [[nodiscard]] const TimeLimit& shortest() const;
};

/// Length of ContactMemory::values under a plan: the remembered numbers of its laws and of its integrator.
std::size_t remembered_numbers(const Plan& plan);

/// The system of a scene without beads: cell, walls, gravity, drive, clock.
System make_system(const Scene& scene, const Plan& plan);

/// The constants of one kind of contact, in the order of Layout (contact.hpp).
/// \param inv_radius_j 0 at a wall
std::vector<double> contact_constants(const ContactLaws& laws, const PairScale& pair, double reach,
                                      double inv_radius_i, double inv_radius_j);

}  // namespace twincell::sim
