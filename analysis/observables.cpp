#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "analysis/motion/centre_of_mass.hpp"
#include "analysis/motion/tracers.hpp"
#include "analysis/observable/no_such_result.hpp"
#include "analysis/observable/observable.hpp"
#include "analysis/observable/timed_analysis.hpp"
#include "core/cancellation.hpp"
#include "core/constants.hpp"
#include "core/plural.hpp"
#include "trajectory/plate.hpp"

// The list: an observable is NAME.cpp in a room of analysis/, which defines NAME_observable.
#define TWINCELL_OBSERVABLES(EACH) \
  EACH(phase_thresholds)           \
  EACH(slip)                       \
  EACH(granular_temperature)       \
  EACH(bond_order)                 \
  EACH(orientation)                \
  EACH(grains)                     \
  EACH(defects)                    \
  EACH(convection)                 \
  EACH(profiles)                   \
  EACH(volume_fraction)            \
  EACH(centre_of_mass)             \
  EACH(bed_flight)                 \
  EACH(pair_correlation)           \
  EACH(structure_factor)           \
  EACH(contact_number)             \
  EACH(voronoi_area)               \
  EACH(mean_squared_displacement)  \
  EACH(velocity_autocorrelation)   \
  EACH(velocity_distribution)      \
  EACH(contact_force)              \
  EACH(stress)                     \
  EACH(stress_field)

namespace twincell::analysis {

#define TWINCELL_DECLARE(name) extern const ObservableEntry name##_observable;
TWINCELL_OBSERVABLES(TWINCELL_DECLARE)
#undef TWINCELL_DECLARE

namespace {

/// The names of the list.
constexpr auto kNames = std::to_array<std::string_view>({
#define TWINCELL_NAME(name) #name,
    TWINCELL_OBSERVABLES(TWINCELL_NAME)
#undef TWINCELL_NAME
});

/// Bytes of the numbers per bead that a frame contains.
double bytes_read(const Frame& f) {
  return static_cast<double>(
      sizeof(Vec3) * (f.position.size() + f.position_sigma.size() + f.velocity.size() + f.spin.size()));
}

/// Bytes that every observable has to read: the positions.
double bytes_needed(const Frame& f) {
  return static_cast<double>(sizeof(Vec3) * f.position.size());
}

/// All observables, in the order of their results and of kNames.
const std::vector<const ObservableEntry*>& entries() {
#define TWINCELL_ADDRESS(name) &name##_observable,
  static const std::vector<const ObservableEntry*> list = {TWINCELL_OBSERVABLES(TWINCELL_ADDRESS)};
#undef TWINCELL_ADDRESS
  return list;
}

void check(const AnalysisOptions& options) {
  const auto names = result_names();
  for (const std::string& name : options.only)
    if (std::find(names.begin(), names.end(), name) == names.end())
      throw ConfigError({.file = {}, .key = "only"}, no_such_result(name) + '.');
  if (options.discard_cycles < 0)
    throw ConfigError({.file = {}, .key = "--discard"},
                      fmt::format("is {}; it must be at least 0.", options.discard_cycles));
  if (options.cycles < 0)
    throw ConfigError({.file = {}, .key = "--cycles"},
                      fmt::format("is {}; it must be at least 1, or 0 for all.", options.cycles));
  if (options.neighbour_cutoff)
    require_range({.file = {}, .key = "cutoff"}, *options.neighbour_cutoff, 0, 5, true);
  require_range({.file = {}, .key = "cell_radius"}, options.cell_radius, 0, 100, true);
  require_range({.file = {}, .key = "field_cell"}, options.field_cell, 0.1, 100);
  if (options.rest_height) require_range({.file = {}, .key = "rest_height"}, *options.rest_height, 0, 1e4);
}

/// Whether the results of an observable depend on an option, with the neighbours of the options.
bool depends(const ObservableEntry& entry, std::string_view option, const AnalysisOptions& options) {
  const auto reads = [&](std::string_view word) {
    return std::find(entry.reads.begin(), entry.reads.end(), word) != entry.reads.end();
  };
  const bool by_cutoff = options.neighbours == NeighbourRule::cutoff;
  if (option == "cutoff") return by_cutoff && reads("neighbours");
  if (option == "cell_radius") return reads(option) || (!by_cutoff && reads("neighbours"));
  return reads(option);
}

/// The options that differ from their defaults, without the cycles.
std::vector<std::string_view> given_options(const AnalysisOptions& options) {
  const AnalysisOptions defaults;
  std::vector<std::string_view> given;
  if (!options.tracers.empty() || options.tracer_band) given.emplace_back("tracers");
  if (options.s_b != defaults.s_b) given.emplace_back("s_b");
  if (options.neighbours != defaults.neighbours) given.emplace_back("neighbours");
  if (options.neighbour_cutoff) given.emplace_back("cutoff");
  if (options.cell_radius != defaults.cell_radius) given.emplace_back("cell_radius");
  if (options.field_cell != defaults.field_cell) given.emplace_back("field_cell");
  if (options.rest_height) given.emplace_back("rest_height");
  return given;
}

/// Builds the context. Tracers and the rest height come from the first frame at phase 0 (from the very first
/// frame if no frame has phase 0 or the frames have no phase).
AnalysisContext make_context(const TrajectorySource& trajectory, const AnalysisOptions& options) {
  const TrajectoryInfo& info = trajectory.info();
  AnalysisContext context{info, options, neighbour_cutoff(info, options), {}, {}, {}, kNaN};
  Frame frame;
  std::size_t index = 0;
  trajectory.read(index, frame);
  if (info.columns.phase)
    while (frame.phase != 0 && index + 1 < trajectory.n_frames()) {
      throw_if_cancelled();
      trajectory.read(++index, frame);
    }
  if (info.columns.phase && frame.phase != 0) trajectory.read(0, frame);

  const TracerChoice choice = choose_tracers(info, frame, {options.tracers, options.tracer_band});
  context.tracers = choice.slots;
  context.tracer_choice = choice.how;
  if (choice.slots.empty()) context.no_tracers = choice.how;
  const double plate = why_not_at_rest(info, frame).empty() ? plate_height(info, frame).value_or(kNaN) : kNaN;
  double sum = 0;
  std::size_t n = 0;
  for (const std::size_t slot : choice.slots) {
    const bool seen = frame.present(slot) && std::isfinite(frame.position[slot].z());
    context.tracer_rest_heights.push_back(seen ? frame.position[slot].z() - plate : kNaN);
    if (!seen) continue;
    sum += frame.position[slot].z();
    ++n;
  }
  if (n > 0) context.tracer_rest_height = sum / static_cast<double>(n) - plate;
  context.rest_height =
      options.rest_height ? options.rest_height : resting_height(info, frame, context.no_rest_height);
  return context;
}

/// \throws ConfigError if the options choose cycles of frames without a cycle number, or none of a drive that
/// changes
void require_cycles(const TrajectorySource& trajectory, const AnalysisOptions& options) {
  const TrajectoryInfo& info = trajectory.info();
  if ((options.discard_cycles > 0 || options.cycles > 0) && !info.columns.phase)
    throw ConfigError({.file = trajectory.name(), .key = options.cycles > 0 ? "--cycles" : "--discard"},
                      "cycles cannot be chosen from a trajectory whose frames have no cycle number");

  if (const std::optional<Drive>& drive = info.drive; drive && drive->ramp && options.cycles == 0)
    throw ConfigError(
        {.file = trajectory.name(), .key = "drive.ramp"},
        fmt::format(
            "the drive changes during the run (displacement {}), so that no result is that of one "
            "drive; analyse windows of cycles (--window-cycles), or choose cycles (--discard, --cycles)",
            drive->formula()));
}

struct ChosenObservable {
  std::string_view name;
  std::unique_ptr<Observable> observable;
};

/// The observables with a requested result.
std::vector<ChosenObservable> choose_observables(const AnalysisContext& context) {
  std::vector<ChosenObservable> chosen;
  for (std::size_t k = 0; k < entries().size(); ++k)
    if (const ObservableEntry& entry = *entries()[k];
        std::any_of(entry.results.begin(), entry.results.end(), [&](const NamedResult& result) {
          return context.options.wants(std::string(result.name));
        }))
      chosen.push_back({kNames[k], entry.make(context)});
  return chosen;
}

/// What was analysed.
struct Used {
  std::size_t frames = 0;
  std::int64_t cycles = 0;  ///< after the skipped ones; counted only if the options choose cycles
};

/// Adds the frames of the chosen cycles to the observables.
Used add_frames(const TrajectorySource& trajectory, const AnalysisContext& context,
                const std::vector<ChosenObservable>& chosen, Progress& progress, StageTimes* times) {
  const AnalysisOptions& options = context.options;
  Used used;
  Frame frame;
  std::int64_t first_cycle = -1;
  // The number of frames is queried each time: a run that is analysed while it is simulated may end early.
  for (std::size_t f = 0; f < trajectory.n_frames(); ++f) {
    throw_if_cancelled();
    {
      Stage reading(times, "reading", "bead-frames");
      trajectory.read(f, frame);
      reading.count(static_cast<double>(frame.position.size()), bytes_read(frame));
    }
    progress.update(static_cast<std::int64_t>(f) + 1, static_cast<std::int64_t>(trajectory.n_frames()));
    if (options.discard_cycles > 0 || options.cycles > 0) {
      if (frame.cycle < 0) continue;
      if (first_cycle < 0) first_cycle = frame.cycle;
      const std::int64_t since = frame.cycle - first_cycle - options.discard_cycles;
      if (since < 0) continue;
      used.cycles = std::max(used.cycles, since + 1);
      if (options.cycles > 0 && since >= options.cycles) break;
    }
    ++used.frames;
    const FrameView view(frame, context);
    for (const auto& [name, observable] : chosen) {
      throw_if_cancelled();
      Stage adding(times, name, "bead-frames");
      observable->add(view);
      adding.count(static_cast<double>(frame.position.size()), bytes_needed(frame));
    }
  }
  return used;
}

/// \throws ConfigError if the chosen cycles have no frame or are fewer than requested
void require_used(const Used& used, const TrajectorySource& trajectory, const AnalysisOptions& options) {
  if (used.frames == 0)
    throw ConfigError({.file = trajectory.name(), .key = "--discard"},
                      "leaving out " + plural(options.discard_cycles, "cycle") + " leaves no frame");
  if (used.cycles < options.cycles)
    throw ConfigError({.file = trajectory.name(), .key = "--cycles"},
                      fmt::format("{} {} requested, but the trajectory has {}{}",
                                  plural(options.cycles, "cycle"), options.cycles == 1 ? "was" : "were",
                                  used.cycles, options.discard_cycles > 0 ? " after the skipped ones" : ""));
}

/// The requested results of the observables, which may have more.
std::vector<Result> requested_results(const std::vector<ChosenObservable>& chosen,
                                      const AnalysisOptions& options, StageTimes* times) {
  std::vector<Result> results;
  for (const auto& [name, observable] : chosen) {
    throw_if_cancelled();
    const Stage finishing(times, name);
    for (Result& r : observable->results()) {
      if (!options.wants(r.name)) continue;
      if (!r.shape.empty() && !r.interval && r.no_interval.empty())
        r.no_interval = "no interval is computed for the elements of an array";
      results.push_back(cut_interval(std::move(r)));
    }
  }
  return results;
}

}  // namespace

void require_read(const AnalysisOptions& options) {
  constexpr std::size_t kMostNames = 8;
  for (const std::string_view option : given_options(options)) {
    std::vector<std::string_view> readers;
    bool read = false;
    for (const ObservableEntry* entry : entries()) {
      if (!depends(*entry, option, options)) continue;
      for (const NamedResult& result : entry->results) {
        readers.push_back(result.name);
        read = read || options.wants(std::string(result.name));
      }
    }
    if (read) continue;
    if (readers.empty())
      throw ConfigError(
          {.file = {}, .key = std::string(option)},
          "is the distance of neighbours with the rule \"cutoff\"; with another rule nothing depends on it.");
    const bool all = readers.size() <= kMostNames;
    if (!all) readers.resize(kMostNames);
    throw ConfigError({.file = {}, .key = std::string(option)},
                      fmt::format("no requested result depends on it; {}{} do.", fmt::join(readers, ", "),
                                  all ? "" : " and others"));
  }
}

std::vector<std::string> result_names() {
  std::vector<std::string> names;
  for (const ObservableEntry* entry : entries())
    for (const NamedResult& result : entry->results) names.emplace_back(result.name);
  return names;
}

NamedResult named_result(std::string_view name) {
  for (const ObservableEntry* entry : entries())
    for (const NamedResult& result : entry->results)
      if (result.name == name) return result;
  return {name};
}

std::vector<Result> analyze(const TrajectorySource& trajectory, const AnalysisOptions& options,
                            Progress& progress) {
  return analyze(trajectory, options, progress, nullptr);
}

std::vector<Result> analyze(const TrajectorySource& trajectory, const AnalysisOptions& options,
                            Progress& progress, StageTimes* times) {
  check(options);
  if (trajectory.n_frames() == 0)
    throw InputError({.file = trajectory.name(), .key = {}}, "the trajectory contains no frame");
  const AnalysisContext context = make_context(trajectory, options);
  require_cycles(trajectory, options);
  const std::vector<ChosenObservable> chosen = choose_observables(context);
  require_used(add_frames(trajectory, context, chosen, progress, times), trajectory, options);
  return requested_results(chosen, options, times);
}

}  // namespace twincell::analysis
