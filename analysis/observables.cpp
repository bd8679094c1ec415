#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "analysis/gas/granular_temperature.hpp"
#include "analysis/gas/profiles.hpp"
#include "analysis/gas/volume_fraction.hpp"
#include "analysis/motion/bed_flight.hpp"
#include "analysis/motion/centre_of_mass.hpp"
#include "analysis/motion/convection.hpp"
#include "analysis/motion/phase_thresholds.hpp"
#include "analysis/motion/slip.hpp"
#include "analysis/motion/tracers.hpp"
#include "analysis/observable/observable.hpp"
#include "analysis/order/defects.hpp"
#include "analysis/order/grains.hpp"
#include "analysis/order/order.hpp"
#include "analysis/order/orientation.hpp"
#include "core/cancellation.hpp"

namespace twincell {
namespace {

/// The list: which results, made by whom.
struct Entry {
  std::vector<std::string> names;
  std::unique_ptr<Observable> (*make)(const AnalysisContext&);
};
const std::vector<Entry>& entries() {
  static const std::vector<Entry> list = {
      {{"s_k", "s_b", "s_b_variance", "s_b_about_rest", "s_b_as_printed", "half_pixel", "s_b_noise",
        "s_j_noise", "s_j", "s_c", "cycle_of_convection", "s_j_growth", "s_j_growth_late", "drift", "phase",
        "tracers", "tracer_heights"},
       make_phase_thresholds},
      {{"p_s", "slips", "p_s_j", "slip_directions", "slip_oblique", "slip_vertical", "slip_horizontal"},
       make_slip},
      {{"T_g", "T_x", "T_y", "T_z", "T", "T_z_eq5", "T_z_field", "T_bar_z", "T_bar", "T_z_tau",
        "T_g_aliasing", "T_z_aliasing", "T_g_sampling"},
       make_granular_temperature},
      {{"q6", "psi6", "psi4", "hexagonal_fraction", "square_fraction", "q6_beads", "psi6_beads",
        "psi4_beads"},
       make_bond_order},
      {{"ordered_fraction", "orientation", "orientation_a", "orientation_b", "orientation_beads"},
       make_orientation},
      {{"grains", "largest_grain", "grain_boundary_fraction", "grain_boundary_angle", "grain_beads"},
       make_grains},
      {{"disclinations_5", "disclinations_7", "disclinations_other", "dislocations", "free_disclinations",
        "holes", "defect_fraction", "defect_fraction_j", "coordination_beads"},
       make_defects},
      {{"displacement_field", "field_x", "field_z", "circulation_left", "circulation_right", "rolls",
        "convection_sense"},
       make_convection},
      {{"profile_z", "phi_z", "T_z_z", "T_x_z", "T_z_frames_z", "T_z_volume"}, make_profiles},
      {{"phi_top", "phi_cm"}, make_volume_fraction},
      {{"h_cm", "h_cm_k", "h_cm_j", "delta_h_cm", "delta_h_bar"}, make_centre_of_mass},
      {{"flight_time", "flight_share"}, make_bed_flight},
  };
  return list;
}

void check(const AnalysisOptions& options) {
  const auto names = result_names();
  for (const std::string& name : options.only)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw ConfigError(
          {.file = {}, .key = "only"},
          fmt::format("there is no result called \"{}\"; there are {}", name, fmt::join(names, ", ")));
  if (options.discard_cycles < 0)
    throw ConfigError({.file = {}, .key = "discard"},
                      fmt::format("{} cycles cannot be left out; at least 0", options.discard_cycles));
  if (options.cycles < 0)
    throw ConfigError({.file = {}, .key = "cycles"},
                      fmt::format("{} cycles cannot be used; at least 1, or 0 for all", options.cycles));
  if (options.neighbour_cutoff)
    require_range({.file = {}, .key = "cutoff"}, *options.neighbour_cutoff, 0, 100, true);
  require_range({.file = {}, .key = "cell_radius"}, options.cell_radius, 0, 100, true);
  require_range({.file = {}, .key = "field_cell"}, options.field_cell, 0.1, 100);
  if (options.rest_height) require_range({.file = {}, .key = "rest_height"}, *options.rest_height, 0, 1e4);
}

/// Chooses tracers on the first frame at phase 0 (the first of all if the frames have no phase).
AnalysisContext make_context(const TrajectorySource& trajectory, const AnalysisOptions& options) {
  const TrajectoryInfo& info = trajectory.info();
  AnalysisContext context{info, options, neighbour_cutoff(info, options),         {},
                          {},   {},      std::numeric_limits<double>::quiet_NaN()};
  Frame frame;
  std::size_t index = 0;
  trajectory.read(index, frame);
  if (info.columns.phase)
    while (frame.phase != 0 && index + 1 < trajectory.n_frames()) trajectory.read(++index, frame);
  if (info.columns.phase && frame.phase != 0) trajectory.read(0, frame);

  const TracerChoice choice = choose_tracers(info, frame, {options.tracers, options.tracer_band});
  context.tracers = choice.slots;
  context.tracer_choice = choice.how;
  if (choice.slots.empty())
    context.no_tracers = info.tracer.empty() ? choice.how : "the trajectory marks no bead as a tracer";
  const auto plate = plate_height(info, frame);
  double sum = 0;
  std::size_t n = 0;
  for (const std::size_t slot : choice.slots) {
    const bool seen = frame.present(slot) && std::isfinite(frame.position[slot].z());
    context.tracer_rest_heights.push_back(seen && plate ? frame.position[slot].z() - *plate
                                                        : std::numeric_limits<double>::quiet_NaN());
    if (!seen) continue;
    sum += frame.position[slot].z();
    ++n;
  }
  if (plate && n > 0) context.tracer_rest_height = sum / static_cast<double>(n) - *plate;
  context.rest_height =
      options.rest_height ? options.rest_height : resting_height(info, frame, context.no_rest_height);
  return context;
}

}  // namespace

double neighbour_cutoff(const TrajectoryInfo& info, const AnalysisOptions& options) {
  return options.neighbour_cutoff.value_or(info.source == "experiment" ? 1.3 : 1.2);
}

bool AnalysisOptions::wants(const std::string& name) const {
  return only.empty() || std::find(only.begin(), only.end(), name) != only.end();
}

double Result::value() const {
  if (!present() || values.empty()) return std::numeric_limits<double>::quiet_NaN();
  return values.front();
}

Result absent_result(const std::string& name, const std::string& reason, const std::string& source) {
  Result r{.name = name};
  r.absent = reason;
  r.source = source;
  return r;
}

Result mean_of(const BlockAverage& series, Result r, const std::string& why_absent) {
  if (series.n() == 0) return absent_result(r.name, why_absent, r.source);
  r.values = {series.mean()};
  r.n = series.n();
  r.interval = series.interval(r.n_of);
  if (!r.interval && r.no_interval.empty()) r.no_interval = series.why_no_interval(r.n_of);
  return r;
}

Result array_of(const std::vector<double>& values, Result r, const std::string& why_absent) {
  r.n = static_cast<std::size_t>(
      std::count_if(values.begin(), values.end(), [](double v) { return std::isfinite(v); }));
  if (r.n == 0) return absent_result(r.name, why_absent, r.source);
  r.values = values;
  r.shape = {values.size()};
  return r;
}

SbForm s_b_named(const std::string& name) {
  if (name == "variance") return SbForm::variance;
  if (name == "about_rest") return SbForm::about_rest;
  if (name == "as_printed") return SbForm::as_printed;
  throw ConfigError({.file = {}, .key = "s_b"},
                    fmt::format("\"{}\" is not one of variance, about_rest, as_printed", name));
}

NeighbourRule neighbour_rule_named(const std::string& name) {
  if (name == "cutoff") return NeighbourRule::cutoff;
  if (name == "delaunay") return NeighbourRule::delaunay;
  if (name == "voronoi") return NeighbourRule::voronoi;
  throw ConfigError({.file = {}, .key = "neighbours"},
                    fmt::format("\"{}\" is not one of cutoff, delaunay, voronoi", name));
}

std::string neighbour_rule_text(const AnalysisContext& context) {
  if (context.options.neighbours == NeighbourRule::cutoff)
    return fmt::format("neighbours: centres within {:.4g} sigma", context.cutoff);
  return fmt::format(
      "neighbours: Voronoi cells within {:.4g} sigma that share an edge{}", context.options.cell_radius,
      context.options.neighbours == NeighbourRule::voronoi ? ", bonds weighted by the length of that edge"
                                                           : "");
}

const Neighbours& FrameView::neighbours() const {
  if (context_.options.neighbours != NeighbourRule::cutoff) return cells().neighbours;
  if (!neighbours_) neighbours_ = find_neighbours(frame_, context_.info.box, context_.cutoff);
  return *neighbours_;
}

const BondOrder& FrameView::order() const {
  if (!order_)
    order_ = context_.options.neighbours == NeighbourRule::voronoi ? bond_order(neighbours(), cells().edge)
                                                                   : bond_order(neighbours());
  return *order_;
}

const VoronoiCells& FrameView::cells() const {
  if (!cells_) cells_ = voronoi_cells(frame_, context_.info.box, context_.options.cell_radius);
  return *cells_;
}

std::vector<std::string> result_names() {
  std::vector<std::string> names;
  for (const Entry& entry : entries()) names.insert(names.end(), entry.names.begin(), entry.names.end());
  return names;
}

const Result* seek_result(const std::vector<Result>& results, const std::string& name) {
  const auto found =
      std::find_if(results.begin(), results.end(), [&](const Result& r) { return r.name == name; });
  return found != results.end() ? &*found : nullptr;
}

const Result& find_result(const std::vector<Result>& results, const std::string& name) {
  const Result* found = seek_result(results, name);
  assert(found != nullptr);
  return *found;
}

std::vector<Result> analyze(const TrajectorySource& trajectory, const AnalysisOptions& options,
                            Progress& progress) {
  check(options);
  if (trajectory.n_frames() == 0)
    throw InputError({.file = trajectory.name(), .key = {}}, "the trajectory holds no frame");
  const AnalysisContext context = make_context(trajectory, options);
  if ((options.discard_cycles > 0 || options.cycles > 0) && !context.info.columns.phase)
    throw ConfigError({.file = trajectory.name(), .key = options.cycles > 0 ? "cycles" : "discard"},
                      "cycles cannot be chosen from a trajectory whose frames have no cycle number");

  std::vector<std::unique_ptr<Observable>> observables;
  for (const Entry& entry : entries())
    if (std::any_of(entry.names.begin(), entry.names.end(),
                    [&](const std::string& name) { return options.wants(name); }))
      observables.push_back(entry.make(context));

  Frame frame;
  std::int64_t first_cycle = -1;
  std::size_t used = 0;
  // The number of frames is asked for each time: a run that is analysed while it goes on may end early.
  for (std::size_t f = 0; f < trajectory.n_frames(); ++f) {
    throw_if_cancelled();
    trajectory.read(f, frame);
    progress.update(static_cast<std::int64_t>(f) + 1, static_cast<std::int64_t>(trajectory.n_frames()));
    if (options.discard_cycles > 0 || options.cycles > 0) {
      if (frame.cycle < 0) continue;
      if (first_cycle < 0) first_cycle = frame.cycle;
      const std::int64_t since = frame.cycle - first_cycle - options.discard_cycles;
      if (since < 0) continue;
      if (options.cycles > 0 && since >= options.cycles) break;
    }
    ++used;
    const FrameView view(frame, context);
    for (const auto& observable : observables) observable->add(view);
  }
  if (used == 0)
    throw ConfigError({.file = trajectory.name(), .key = "discard"},
                      fmt::format("leaving out {} cycles leaves no frame", options.discard_cycles));

  std::vector<Result> results;
  for (const auto& observable : observables) {
    throw_if_cancelled();
    for (Result& r : observable->results()) {
      if (!options.wants(r.name)) continue;
      if (!r.shape.empty() && !r.interval && r.no_interval.empty())
        r.no_interval = "an array: one value for each element";
      results.push_back(std::move(r));
    }
  }
  return results;
}

}  // namespace twincell
