#pragma once
/// \file
/// What a time step is worth and what it costs: errors of the integrators against closed forms, and processor
/// time on a driven bed. The contacts are those of Fortini & Huang 2015 (Table I), scaled to a stiffness.

#include <optional>
#include <string>
#include <vector>

#include "core/progress.hpp"
#include "sim/accuracy/impacts.hpp"
#include "sim/scene/scene.hpp"
#include "sim/scene/step_setting.hpp"

namespace twincell::sim {

/// Errors of one collision: of e (Fortini & Huang 2015, eq. A5) and of v_t'/v_t without slip.
struct CollisionErrors {
  PhaseSpread restitution_pair, restitution_wall;
  PhaseSpread sticking_pair, sticking_wall;  ///< two beads; a bead and the plate

  [[nodiscard]] double restitution() const;  ///< the larger of the two largest
  [[nodiscard]] double sticking() const;
};
/// Oblique impacts at 45 degrees, one for each of `phases` entry phases, evenly spread. A pair turns while in
/// contact, by v t_c, which the closed form does not know: v is 1e-3 sqrt(g sigma).
CollisionErrors collision_errors(const StepSetting& setting, int phases = 128);

/// Errors of beads at rest, 2250 contact times after their release (5 t0 for the paper's k_n; the column,
/// whose slowest mode takes longer, four times that).
struct BedErrors {
  double kinetic_energy = 0;  ///< per bead, m g sigma, of a crystal of 40 beads displaced by up to 1e-4 sigma
  double floor_force = 0;     ///< its largest |F/(N m g) - 1| over ten contact times
  double overlap = 0;         ///< largest |delta k_n/(i m g) - 1| in a column of five beads
};
BedErrors bed_errors(const StepSetting& setting);

/// A gas of the second paper.
struct GasCase {
  std::string system = "smooth-2d";  ///< of the presets bhateja-2016-...
  double w = 20;
  bool event_driven =
      false;  ///< beads fly from contact to contact; the setting then acts where three bodies meet
  bool operator==(const GasCase&) const = default;
};

/// T_z/(m V_p^2), m <(v_z - v_z,cm)^2>, of a gas (Bhateja et al. 2016), and the standard error that the
/// length of the run leaves it, from ten blocks. The start is forgotten for 50 periods.
struct GasTemperature {
  StepSetting setting;
  GasCase gas;
  double value = 0, standard_error = 0;
  int periods = 0;
  double seconds = 0;  ///< of processor time, for `periods`

  /// Processor time after which the statistical error is the share `relative` of the value.
  [[nodiscard]] double seconds_to(double relative) const;
};
GasTemperature gas_temperature(const StepSetting& setting, const GasCase& gas, int periods,
                               Progress& progress = Progress::none());

/// Processor time of one step.
struct StepCost {
  double seconds_per_time = 0;  ///< s/t0, of one bead
  double dt = 0;                ///< t0
  double contact_time = 0;      ///< t0, of two beads
};
/// Cost of settings on one driven bed: 400 beads of the first paper at Gamma = 2, five windows of a hundredth
/// of a period at five phases of the third period, each entered from the same state and run half as long
/// again before the clock starts. Settings take turns within a round, so that what else the machine does hits
/// all alike; the median over rounds counts. One thread.
std::vector<StepCost> step_costs(const std::vector<StepSetting>& settings, int rounds,
                                 Progress& progress = Progress::none());

/// What a setting is worth and what it costs.
struct WorkPrecision {
  StepSetting setting;
  CollisionErrors collision;
  BedErrors bed;
  StepCost cost;
  ImpactErrors impacts = {};  ///< of bed_impacts()
};
/// What the first paper's bed has of impacts that slide or stick: a hundred each at Gamma = 2 and 3
/// (impacts_of_a_bed), each at kBedPhases entry phases.
std::vector<Impact> bed_impacts();
inline constexpr int kBedPhases = 8;
/// The first paper's contact at another stiffness, for impacts.
Scene scaled_impact_scene(double k_n);

/// All of it, for each setting.
std::vector<WorkPrecision> work_precision(const std::vector<StepSetting>& settings, int rounds,
                                          Progress& progress = Progress::none());

/// Settings that no other of the same k_n beats in both largest error of e and time, cheapest first.
std::vector<WorkPrecision> front(const std::vector<WorkPrecision>& all, double k_n);

/// The cheapest setting of stiffness k_n whose largest error of e is at most `accuracy`, for it and for every
/// larger n of its integrator, so that no lucky phase counts. Absent if there is none.
std::optional<WorkPrecision> cheapest(const std::vector<WorkPrecision>& all, double k_n, double accuracy);

/// The cheapest setting that is no less accurate than `reference` is: largest and rms error of e and of
/// v_t'/v_t without slip, for two beads and for a bead and the plate each, of e, v_t' and w' of a bed's
/// impacts, and beads at rest no worse or within 1e-12 m g
/// sigma, 1e-8 N m g and 1e-5 of each overlap. It and every larger n of its integrator pass; `reference`
/// itself does. \param mean also the mean errors are no larger: what an average over very many collisions
/// sees
WorkPrecision equal_accuracy(const std::vector<WorkPrecision>& all, const WorkPrecision& reference,
                             bool mean = false);

}  // namespace twincell::sim
