#pragma once
/// \file
/// Accuracy and cost of time steps: errors of the integrators against closed forms, and processor time on a
/// driven bed. The contacts are those of Fortini & Huang 2015 (Table I), scaled to a stiffness.

#include <optional>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "sim/accuracy/impacts.hpp"
#include "sim/accuracy/step_setting.hpp"
#include "sim/scene/scene.hpp"

namespace twincell::sim {

/// Errors of one collision: of e (Fortini & Huang 2015, eq. A5), and of v_t'/v_t without slip.
struct CollisionErrors {
  EntryPhaseSpread restitution_pair, restitution_wall;
  EntryPhaseSpread sticking_pair, sticking_wall;  ///< two beads; a bead and the plate

  /// Largest error of e: the larger of restitution_pair.largest and restitution_wall.largest.
  [[nodiscard]] double restitution() const;
  /// Largest error of v_t'/v_t: the larger of sticking_pair.largest and sticking_wall.largest.
  [[nodiscard]] double sticking() const;
};
/// Simulates oblique impacts at 45 degrees, one for each of `phases` evenly spaced entry phases. A pair
/// rotates by v t_c while in contact, which the closed form neglects; v is therefore 1e-3 sqrt(g sigma).
CollisionErrors collision_errors(const StepSetting& setting, int phases = 128);

/// Errors of beads at rest, 2250 contact times after their release (5 t0 for the k_n of the paper). The
/// column is given four times as long, because its slowest mode decays more slowly.
struct BedErrors {
  double kinetic_energy = 0;  ///< per bead, m g sigma, of a crystal of 40 beads displaced by up to 1e-4 sigma
  double floor_force = 0;     ///< of the same bed, largest |F/(N m g) - 1| over ten contact times
  double overlap = 0;         ///< largest |delta k_n/(i m g) - 1| in a column of five; i: beads carried
};
/// Lets a crystal of 40 beads and a column of five come to rest with time steps and compares them with
/// statics.
/// \throws ConfigError for an integrator or n that a scene refuses
BedErrors bed_errors(const StepSetting& setting);

/// A gas of the second paper.
struct GasCase {
  std::string system = "smooth-2d";  ///< one of the presets bhateja-2016-...
  double w = 20;
  /// Event-driven motion; the setting then applies only where three bodies meet.
  bool event_driven = false;
  bool operator==(const GasCase&) const = default;
};

/// Vertical granular temperature of a gas (Bhateja et al. 2016), m <(v_z - v_z,cm)^2>/(m V_p^2), and its
/// standard error for this length of the run, from ten blocks. The first 50 periods are discarded.
struct GasTemperature {
  StepSetting setting;
  GasCase gas;
  double value = 0, standard_error = 0;
  int periods = 0;
  double seconds = 0;  ///< of processor time, for `periods`

  /// Processor time after which the statistical error is the fraction `relative` of the value.
  [[nodiscard]] double seconds_to(double relative) const;
};
/// Simulates the gas for `periods` periods, at least ten, after the discarded ones.
/// \throws ConfigError for a setting, system or w that a scene refuses; RunError if the run fails
GasTemperature gas_temperature(const StepSetting& setting, const GasCase& gas, int periods,
                               Progress& progress = Progress::none());

/// Processor time of one step.
struct StepCost {
  double seconds_per_time = 0;  ///< per bead, s/t0
  double dt = 0;                ///< t0
  double contact_time = 0;      ///< of two beads, t0
};
/// Cost of settings on one driven bed: 400 beads of the first paper at Gamma = 2, five windows of a hundredth
/// of a period each, at five phases of the third period. Every setting enters a window from the same state
/// and first runs half a window without timing. The settings take turns within a round, so that other load on
/// the machine affects all of them equally; the result is the median over rounds. One thread.
std::vector<StepCost> step_costs(const std::vector<StepSetting>& settings, int rounds,
                                 Progress& progress = Progress::none());

/// Accuracy and cost of a setting.
struct WorkPrecision {
  StepSetting setting;
  CollisionErrors collision;
  BedErrors bed;
  StepCost cost;
  ImpactErrors impacts = {};  ///< for bed_impacts()
};

/// Stiffness k_n of Fortini & Huang 2015 (Table I), m g/sigma.
inline constexpr double kPaperStiffness = 1e6;
/// Rms error of the spin at which Verlet and split are compared (equal_impacts), relative to its change.
inline constexpr double kComparedSpinError = 0.01;
/// The settings that a study compares: Verlet, predicted and split, each with eleven numbers of steps per
/// contact from 6.37 to 400.37, for k_n = 1e5, 1e6 and 1e7. No number of steps is an integer: otherwise
/// contacts of equal duration would all end at the same point within a step.
/// \param quick k_n of the paper alone, with four numbers of steps from 6.37 to 50.37
std::vector<StepSetting> study_settings(bool quick);
/// Verlet with the longest step of study_settings(), for k_n of the paper.
StepSetting longest_study_step();

/// Impacts in the bed of the first paper, sliding and sticking: a hundred each at Gamma = 2 and 3
/// (impacts_of_a_bed), each used at kBedPhases entry phases.
std::vector<Impact> bed_impacts();
inline constexpr int kBedPhases = 8;
/// Scene for impacts with the contact of the first paper, scaled to another stiffness k_n, m g/sigma.
Scene scaled_impact_scene(double k_n);

/// Accuracy and cost of each setting.
std::vector<WorkPrecision> work_precision(const std::vector<StepSetting>& settings, int rounds,
                                          Progress& progress = Progress::none());

/// Pareto front: settings for which no other of the same k_n is better in both the largest error of e and the
/// time, cheapest first.
std::vector<WorkPrecision> front(const std::vector<WorkPrecision>& all, double k_n);

/// The cheapest setting of stiffness k_n whose largest error of e is at most `accuracy` (absolute). Every
/// larger n of its integrator must pass too, so that a fortunate phase does not count. Absent if no setting
/// passes.
std::optional<WorkPrecision> cheapest(const std::vector<WorkPrecision>& all, double k_n, double accuracy);

/// The cheapest setting that is at least as accurate as `reference`. It must not exceed the reference in the
/// following errors:
///
/// - largest and rms error of e and of v_t'/v_t without slip, for two beads and for a bead and the plate
/// - largest and rms error of e, v_t' and w' for the impacts of a bed
/// - errors of beads at rest, where values within 1e-12 m g sigma, 1e-8 N m g and 1e-5 of each overlap always
///  pass
///
/// Every larger n of its integrator must pass too. `reference` itself always passes.
/// \param mean require also that the mean errors are no larger; they matter for averages over very many
/// collisions
WorkPrecision equal_accuracy(const std::vector<WorkPrecision>& all, const WorkPrecision& reference,
                             bool mean = false);

}  // namespace twincell::sim
