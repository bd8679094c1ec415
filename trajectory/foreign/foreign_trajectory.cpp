#include "trajectory/foreign/foreign_trajectory.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <cctype>
#include <cmath>
#include <map>
#include <utility>

#include "core/error.hpp"
#include "trajectory/ranges.hpp"
#include "trajectory/spacing.hpp"
#include "trajectory/wrapped_positions.hpp"

namespace twincell {

namespace {

[[noreturn]] void refuse(const std::string& option, const std::string& why) {
  throw ConfigError({"", 0, 0, option}, why);
}

/// Median distance to the nearest other bead (spacing.hpp) within one period.
double spacing_of(const ForeignFrame& s) {
  Box period{.lower = s.lower, .upper = s.upper};
  for (std::size_t k = 0; k < 3; ++k)
    period.boundary[k] =
        s.periodic[k] && period.size()[static_cast<int>(k)] > 0 ? Boundary::periodic : Boundary::open;
  std::vector<Vec3> centres;
  centres.reserve(s.beads.size());
  for (const ForeignBead& b : s.beads) centres.push_back(period.wrap(b.position));
  return median_spacing(centres);
}

/// Units of time by their names in lower case, and their lengths in seconds.
constexpr std::array<std::pair<std::string_view, double>, 28> kTimeUnits = {{{"s", 1},
                                                                             {"sec", 1},
                                                                             {"secs", 1},
                                                                             {"second", 1},
                                                                             {"seconds", 1},
                                                                             {"ms", 1e-3},
                                                                             {"msec", 1e-3},
                                                                             {"millisecond", 1e-3},
                                                                             {"milliseconds", 1e-3},
                                                                             {"us", 1e-6},
                                                                             {"usec", 1e-6},
                                                                             {"\u00b5s", 1e-6},
                                                                             {"\u03bcs", 1e-6},
                                                                             {"microsecond", 1e-6},
                                                                             {"microseconds", 1e-6},
                                                                             {"ns", 1e-9},
                                                                             {"nsec", 1e-9},
                                                                             {"nanosecond", 1e-9},
                                                                             {"nanoseconds", 1e-9},
                                                                             {"min", 60},
                                                                             {"mins", 60},
                                                                             {"minute", 60},
                                                                             {"minutes", 60},
                                                                             {"h", 3600},
                                                                             {"hr", 3600},
                                                                             {"hour", 3600},
                                                                             {"hours", 3600},
                                                                             {"d", 86400}}};

std::string in_lower_case(std::string word) {
  std::transform(word.begin(), word.end(), word.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  return word;
}

/// Length of the unit of time with this name, s; nothing if the name is not known.
std::optional<double> seconds_of(const std::string& unit) {
  const std::string word = in_lower_case(unit);
  for (const auto& [name, seconds] : kTimeUnits)
    if (word == name) return seconds;
  return {};
}

/// Says in which unit times are read; empty if that is the unit of the file and no other is likely.
std::string conversion_of_times(const std::string& unit) {
  constexpr std::array<std::string_view, 5> kReduced = {"", "t0", "tau", "lj", "sqrt(sigma/g)"};
  if (std::find(kReduced.begin(), kReduced.end(), in_lower_case(unit)) != kReduced.end()) return {};
  const std::optional<double> seconds = seconds_of(unit);
  if (seconds == 1.0) return {};
  if (seconds)
    return fmt::format(
        "the times and velocities of the file are in {} and are converted to seconds; --gravity, --timestep "
        "and --drive-omega are in seconds too (9810 for mm).",
        unit);
  return fmt::format(
      "the file states its times in '{}', which is not a known unit of time: they are taken as they are, and "
      "--gravity, --timestep and --drive-omega are in this unit.",
      unit.substr(0, 40));
}

/// Reads the next frame, converts its times and velocities to seconds if the file states a unit of them, and
/// sorts its beads by id. \throws InputError if an id occurs twice
bool next_sorted(ForeignReader& reader, ForeignFrame& s) {
  if (!reader.next(s)) return false;
  if (const double unit = seconds_of(reader.time_unit()).value_or(1); unit != 1) {
    if (s.time) *s.time *= unit;
    for (ForeignBead& bead : s.beads) {
      bead.velocity /= unit;
      bead.spin /= unit;
    }
  }
  std::stable_sort(s.beads.begin(), s.beads.end(),
                   [](const ForeignBead& a, const ForeignBead& b) { return a.id < b.id; });
  const auto twice =
      std::adjacent_find(s.beads.begin(), s.beads.end(),
                         [](const ForeignBead& a, const ForeignBead& b) { return a.id == b.id; });
  if (twice != s.beads.end())
    reader.fail_at(std::next(twice)->line,
                   fmt::format("the bead with id {} occurs twice in a frame.", twice->id));
  return true;
}

/// What the frames state about one bead.
struct SeenBead {
  double radius, mass;  ///< mean of the radii, sigma; first mass
  double tracer;        ///< frames in which it is marked as a tracer
  double least, most;   ///< radii, sigma
  long type;
  double n = 1;  ///< frames
};

/// The beads of all frames.
struct SeenBeads {
  std::map<std::int64_t, SeenBead> of_id;
  std::optional<std::size_t> fewest;  ///< beads in a frame

  void add(const ForeignFrame& s, const ForeignOptions& o, std::optional<long> tracer_type) {
    for (const ForeignBead& a : s.beads) {
      const SeenBead bead{a.radius / o.sigma,
                          a.mass / o.bead_mass.value_or(1),
                          tracer_type == a.type ? 1. : 0.,
                          a.radius / o.sigma,
                          a.radius / o.sigma,
                          a.type};
      const auto [at, is_new] = of_id.emplace(a.id, bead);
      if (is_new) continue;
      SeenBead& known = at->second;
      known.radius += (bead.radius - known.radius) / ++known.n;  // equal radii stay equal to the bit
      known.tracer += bead.tracer;
      known.least = std::min(known.least, bead.radius);
      known.most = std::max(known.most, bead.radius);
    }
    fewest = std::min(fewest.value_or(s.beads.size()), s.beads.size());
  }
};

/// Complaint about radii that change; empty if each bead keeps its own.
std::string changing_radii(const SeenBeads& seen) {
  constexpr double kSameSize = 0.1;  // sizes that a tracker measures vary from frame to frame
  if (!std::ranges::any_of(seen.of_id, [](const auto& bead) {
        return bead.second.most - bead.second.least > kSameSize * bead.second.radius;
      }))
    return {};
  return "the radii of beads change by more than a tenth from frame to frame: each has its mean.";
}

/// Complaint about beads that are tracers in some frames only; empty if there are none.
std::string changing_tracers(const SeenBeads& seen) {
  const auto n = std::ranges::count_if(seen.of_id, [](const auto& bead) {
    return bead.second.tracer > 0 && bead.second.tracer < bead.second.n;
  });
  if (n == 0) return {};
  return fmt::format("{} in some frames only (wrong links?): each bead is what it is in most frames.",
                     n == 1 ? "1 bead is a tracer" : fmt::format("{} beads are tracers", n));
}

/// Complaint about masses that are not read; empty if all are equal.
std::string unread_masses(const SeenBeads& seen) {
  constexpr double kSameMass = 1e-6;  // of single precision
  if (seen.of_id.empty()) return {};
  const auto lighter = [](const auto& a, const auto& b) { return a.second.mass < b.second.mass; };
  const auto [least, most] = std::minmax_element(seen.of_id.begin(), seen.of_id.end(), lighter);
  if (!(most->second.mass > (1 + kSameMass) * least->second.mass)) return {};
  return fmt::format(
      "the masses of the file, {:.6g} to {:.6g}, are not read, because their unit "
      "is not known (--bead-mass; 1 for a file that twincell exported).",
      least->second.mass, most->second.mass);
}

/// Complaint about types none of which marks tracers; empty if all beads have the same.
std::string unused_types(const SeenBeads& seen) {
  constexpr std::size_t kMaxNamedTypes = 4;
  std::map<long, std::size_t> beads_of_type;
  for (const auto& [id, bead] : seen.of_id) ++beads_of_type[bead.type];
  if (beads_of_type.size() <= 1) return {};
  std::vector<std::string> words;
  for (const auto& [type, beads] : beads_of_type) words.push_back(fmt::format("{} of type {}", beads, type));
  return fmt::format("the file has beads of {} types{}, and none is taken for a tracer (--tracer-type).",
                     words.size(),
                     words.size() > kMaxNamedTypes ? "" : fmt::format(" ({})", fmt::join(words, ", ")));
}

}  // namespace

struct ForeignTrajectory::Impl {
  std::filesystem::path path;
  const ForeignFormat* format = nullptr;
  ForeignOptions o;
  Vec3 origin = Vec3::Zero();  ///< in the axes of ForeignFrame
  TrajectoryInfo info;
  std::size_t n_frames = 0;
  std::vector<std::int64_t> ids;  ///< of the slots, ascending
  double t0 = 1;
  std::int64_t first_cycle = 0;
  std::optional<Vec3> first_position;
  std::array<bool, 2> flat = {true, true};  ///< all beads have the same y; the same z
  std::optional<double> time_before;        ///< that the file states of the frame before, its unit
  bool replaces_times = false;
  double step_distance = 0, step_range = 0;  ///< smallest between two frames; first to last
  double spacing = 0;                        ///< of the beads of the first frame, sigma
  std::size_t beyond = 0;                    ///< beads of the first frame beside the cell
  PositionExtent extent;                     ///< of all beads and frames, axes and unit of ForeignFrame
  std::string assumption, length_unit;
  bool time_in_seconds = false;

  /// Converts a vector from the axes of ForeignFrame to those of Box. In 2D, its y is our z, and its -z
  /// is our y.
  [[nodiscard]] Vec3 turned(const Vec3& v) const {
    return o.dimension == 2 ? Vec3(v.x(), -v.z() + 0.0, v.y()) : v;
  }

  [[nodiscard]] std::unique_ptr<ForeignReader> open() const {
    return format->open(path, {.dimension = o.dimension, .columns = o.table_columns, .y_up = o.y_up});
  }

  void check_options() {
    const auto positive = [](const char* option, double value) {
      require_range({"", 0, 0, option}, value, 0.0, std::nullopt, true);
    };
    positive("--sigma", o.sigma);
    positive("--gravity", o.gravity);
    if (o.timestep) positive("--timestep", *o.timestep);
    if (o.width) positive("--cell-width", *o.width);
    if (o.bead_mass) positive("--bead-mass", *o.bead_mass);
    if (o.dimension == 2 && o.drive_axis == Axis::y) refuse("--drive-axis", "a 2D system has no y axis.");
    require_range({"", 0, 0, "--phase-of-step-zero"}, o.phase_of_step_zero, 0.0, 1.0);
    t0 = std::sqrt(o.sigma / o.gravity);
    const auto scaled = [](std::optional<double> value, double unit) {
      return value ? std::optional(*value / unit) : std::nullopt;
    };
    const DriveSpec spec = {.amplitude = scaled(o.drive.amplitude, o.sigma),
                            .omega = scaled(o.drive.omega, 1 / t0),
                            .frequency = scaled(o.drive.frequency, 1 / t0),
                            .gamma = o.drive.gamma,
                            .k_m = o.drive.k_m,
                            .peak_velocity = scaled(o.drive.peak_velocity, o.sigma / t0)};
    if (spec.amplitude || spec.omega || spec.frequency || spec.gamma || spec.k_m || spec.peak_velocity)
      info.drive = solve_drive(spec, 1, {"", 0, 0, "--drive"}, o.drive_axis);
    if (o.phases_per_cycle > 0 && !info.drive)
      refuse("--frames-per-cycle", "has no meaning without the drive, whose period is then unknown.");
  }

  /// First pass: the origin of a cell with periods is where these begin.
  void begin(const ForeignFrame& first) {
    for (int k = 0; k < 3; ++k)
      if (!o.origin && first.periodic[static_cast<std::size_t>(k)]) origin[k] = first.lower[k];
    info.box.lower = Vec3::Zero();
  }

  /// First pass: checks a frame against the options and the first frame, and extends the box.
  void learn(const ForeignReader& reader, const ForeignFrame& s, const ForeignFrame& first) {
    if (!o.timestep && !s.time)
      refuse("--timestep", fmt::format("{} does not state the length of a step.", path.string()));
    for (int k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(k);
      if (s.periodic[a] != first.periodic[a] ||
          (s.periodic[a] && (s.lower[k] != first.lower[k] || s.upper[k] != first.upper[k])))
        reader.fail_at(s.line, "the box is not periodic as it was in the first frame.");
    }
    if (o.timestep && s.time && std::abs(time(s) * t0 - *s.time) > 1e-6 * std::abs(*s.time))
      replaces_times = true;
    if (!o.timestep && time_before && !(*s.time > *time_before))
      reader.fail_at(s.line, fmt::format("time {:g} of a frame comes after time {:g}; times must increase.",
                                         *s.time, *time_before));
    time_before = s.time;
    for (const ForeignBead& a : s.beads) {
      if (!((a.position - origin).cwiseAbs().maxCoeff() <= kFarthestPosition * o.sigma))
        reader.fail_at(a.line,
                       fmt::format("bead {} is at ({:g}, {:g}, {:g}), farther than {:g} bead diameters "
                                   "from the origin of the cell.",
                                   a.id, a.position.x(), a.position.y(), a.position.z(), kFarthestPosition));
      extent.add(a.position);
      constexpr double kSamePlane_sigma = 1e-9;
      if (!first_position) first_position = a.position;
      for (const int k : {1, 2})
        if (std::abs(a.position[k] - (*first_position)[k]) > kSamePlane_sigma * o.sigma) flat[k - 1] = false;
      if (o.dimension == 2 && !flat[1])
        reader.fail_at(a.line, fmt::format("bead {} is at z = {:g}, not in the plane z = {:g} of the first "
                                           "bead; is this a three-dimensional system (--dimension 3)?",
                                           a.id, a.position.z(), first_position->z()));
    }
    Vec3 end = s.upper - origin;
    for (int k = 0; k < 3; ++k)
      if (s.periodic[static_cast<std::size_t>(k)]) end[k] = s.upper[k] - s.lower[k];
    const Vec3 upper = turned(end) / o.sigma;
    info.box.upper = n_frames == 0 ? upper : Vec3(info.box.upper.cwiseMax(upper));
  }

  /// First pass: checks that the steps increase, and enters their distances.
  /// \param[in,out] before its step is that of the frame before, and becomes that of this frame
  void follow_steps(const ForeignReader& reader, const ForeignFrame& s, ForeignFrame& before) {
    if (n_frames > 0 && s.step <= before.step)
      reader.fail_at(s.line, fmt::format("step {} comes after step {}.", s.step, before.step));
    if (n_frames > 0) {
      const double distance = static_cast<double>(s.step) - static_cast<double>(before.step);
      step_distance = step_distance > 0 ? std::min(step_distance, distance) : distance;
      step_range += distance;
    }
    before.step = s.step;
    if (o.phases_per_cycle > 0) {
      const std::int64_t n = phase_count(reader, s), per_cycle = o.phases_per_cycle;
      if (n_frames == 0) first_cycle = (n - (n % per_cycle + per_cycle) % per_cycle) / per_cycle;
    }
  }

  /// Number of phases since the start of the cycle that contains step 0.
  /// \throws InputError if the frame is between two phases
  [[nodiscard]] std::int64_t phase_count(const ForeignReader& reader, const ForeignFrame& s) const {
    constexpr double kMaxPhaseError = 0.05;
    const double phases = cycles(s) * o.phases_per_cycle, nearest = std::round(phases);
    if (std::abs(phases - nearest) > kMaxPhaseError || std::abs(phases) > 1e15)
      reader.fail_at(s.line,
                     fmt::format("step {} is at {:.4f} cycles, not at one of {} phases of a cycle; check the "
                                 "time step, the drive and the frames per cycle.",
                                 s.step, cycles(s), o.phases_per_cycle));
    return static_cast<std::int64_t>(nearest);
  }
  [[nodiscard]] double time(const ForeignFrame& s) const {
    return (o.timestep ? static_cast<double>(s.step) * *o.timestep : s.time.value_or(0)) / t0;
  }
  [[nodiscard]] double cycles(const ForeignFrame& s) const {
    return time(s) / info.drive->period() + o.phase_of_step_zero;
  }

  /// Type that marks tracers: that of the options, or of a file that marks them itself.
  [[nodiscard]] std::optional<long> tracer_type(const ForeignColumns& columns) const {
    return columns.tracer && !o.tracer_type ? std::optional(2L) : o.tracer_type;
  }

  /// End of the first pass: gives every bead a slot, in the order of the ids.
  void make_slots(const SeenBeads& seen) {
    for (const auto& [id, bead] : seen.of_id) {
      ids.push_back(id);
      info.radius.push_back(bead.radius);
      info.mass.push_back(bead.mass);
      info.tracer.push_back(2 * bead.tracer > bead.n ? 1 : 0);
    }
    info.columns.identity = *seen.fewest < ids.size();
  }

  /// End of the first pass: says what was assumed where the file is silent or its numbers are not used.
  void state_assumptions(const ForeignReader& reader, const SeenBeads& seen) {
    const ForeignColumns& columns = reader.columns();
    assumption = reader.assumption();
    time_in_seconds = seconds_of(reader.time_unit()).has_value();
    const auto add = [&](const std::string& sentence) {
      if (!sentence.empty()) assumption += std::string(assumption.empty() ? "" : " ") + sentence;
    };
    add(conversion_of_times(reader.time_unit()));
    if (columns.radius) add(changing_radii(seen));
    if (columns.mass && !o.bead_mass) add(unread_masses(seen));
    if (columns.type && !tracer_type(columns)) add(unused_types(seen));
    if (tracer_type(columns)) add(changing_tracers(seen));
  }

  /// End of the first pass: sets columns, box and boundaries.
  /// \param y_down whether y of the file increases downwards
  void complete(const ForeignFrame& first, const ForeignColumns& columns, bool y_down) {
    info.n_beads = ids.size();
    info.source = o.source.value_or(format->source);
    const auto all = [&](const std::array<bool, 3>& of) {
      return of[0] && of[1] && (o.dimension == 2 || of[2]);
    };
    info.columns.velocity = all(columns.velocity);
    info.columns.spin = o.dimension == 2 ? columns.spin[2] : all(columns.spin);
    info.columns.position_sigma = columns.uncertainty;
    info.columns.phase = o.phases_per_cycle > 0;
    info.columns.plate_height = info.drive.has_value();
    info.phases_per_cycle = o.phases_per_cycle;
    info.box.dimension = o.dimension;
    const auto edge = [&](std::size_t k) { return first.periodic[k] ? Boundary::periodic : Boundary::wall; };
    info.box.boundary = {edge(0), o.dimension == 2 ? Boundary::open : edge(1),
                         o.dimension == 2 ? edge(1) : edge(2)};
    constexpr double kRounding = 1e-9;
    if (const double period = first.upper.x() - first.lower.x();
        o.width && first.periodic[0] && std::abs(*o.width - period) > kRounding * period)
      refuse("--cell-width", fmt::format("is {:g}, but the file is periodic along x with a period of {:g}.",
                                         *o.width, period));
    if (o.width) info.box.upper.x() = *o.width / o.sigma;
    spacing = spacing_of(first) / o.sigma;
    if (info.box.boundary[0] == Boundary::wall)
      beyond = static_cast<std::size_t>(
          std::count_if(first.beads.begin(), first.beads.end(), [&](const ForeignBead& a) {
            const double x = (a.position.x() - origin.x()) / o.sigma;
            return x < 0 || x > info.box.upper.x();
          }));
    // A file without a box along z states no gap of the glass plates.
    if (const double gap = first.upper.z() - first.lower.z(); o.dimension == 2)
      info.box.upper.y() = gap > 0 ? gap / o.sigma : 1;
    if (!columns.radius) info.radius.clear();
    if (!columns.mass || !o.bead_mass) info.mass.clear();
    if (!tracer_type(columns)) info.tracer.clear();
    if (o.tracer_type && !columns.type) refuse("--tracer-type", "the file has no types of beads.");
    if (!(info.box.upper.minCoeff() > 0))
      refuse(
          "--cell-origin",
          fmt::format(
              "the origin of the cell, its lower left corner, is above or to the right of all beads.{}",
              y_down ? " y of this file increases downwards; --y-up is for a table whose y does not." : ""));
  }

  /// Period of each axis along which the positions are wrapped; 0 along the others.
  [[nodiscard]] Vec3 wrapping(const ForeignFrame& s, const ForeignColumns& columns) const {
    Vec3 period = Vec3::Zero();
    for (int k = 0; k < 3; ++k) {
      const auto axis = static_cast<std::size_t>(k);
      const double length = s.upper[k] - s.lower[k];
      if (s.periodic[axis] && columns.wrapped[axis] && extent.is_wrapped(k, length, o.sigma))
        period[k] = length;
    }
    return period;
  }

  [[nodiscard]] std::size_t slot_of(const ForeignReader& reader, const ForeignBead& a) const {
    const auto at = std::lower_bound(ids.begin(), ids.end(), a.id);
    if (at == ids.end() || *at != a.id) reader.fail_at(a.line, "the file changed while it was read.");
    return static_cast<std::size_t>(at - ids.begin());
  }

  /// Second pass: converts a foreign frame to a Frame with slots, unwrapped coordinates and reduced units.
  void fill(const ForeignReader& reader, const ForeignFrame& s, PeriodCounter& periods, Frame& frame) const {
    frame.step = s.step;
    frame.time = time(s);
    if (info.drive) {
      double fraction = cycles(s) - std::floor(cycles(s));
      if (o.phases_per_cycle > 0) {
        const std::int64_t n = phase_count(reader, s), per_cycle = o.phases_per_cycle;
        frame.phase = static_cast<std::int32_t>((n % per_cycle + per_cycle) % per_cycle);
        frame.cycle = (n - frame.phase) / per_cycle - first_cycle;
        fraction = static_cast<double>(frame.phase) / o.phases_per_cycle;
      }
      frame.plate_height = info.drive->displacement(fraction);
    }
    const Vec3 nowhere = Vec3::Constant(std::nan(""));
    frame.position.assign(ids.size(), nowhere);
    frame.velocity.assign(info.columns.velocity ? ids.size() : 0, nowhere);
    frame.spin.assign(info.columns.spin ? ids.size() : 0, nowhere);
    frame.position_sigma.assign(info.columns.position_sigma ? ids.size() : 0, nowhere);
    frame.id.assign(info.columns.identity ? ids.size() : 0, -1);
    for (const ForeignBead& a : s.beads) {
      const std::size_t slot = slot_of(reader, a);
      const Vec3 r = periods.unwrapped(slot, a.position);
      frame.position[slot] = turned(r - origin) / o.sigma;
      if (o.dimension == 2) frame.position[slot].y() = 0;
      if (info.columns.velocity) frame.velocity[slot] = turned(a.velocity) * (t0 / o.sigma);
      if (info.columns.spin) frame.spin[slot] = turned(a.spin) * t0;
      if (info.columns.position_sigma) {
        const Vec3& u = a.uncertainty;  // has no sign
        frame.position_sigma[slot] = (o.dimension == 2 ? Vec3(u.x(), std::nan(""), u.y()) : u) / o.sigma;
      }
      if (info.columns.identity) frame.id[slot] = static_cast<std::int64_t>(slot);
    }
  }
};

ForeignTrajectory::ForeignTrajectory(const std::filesystem::path& path, const ForeignFormat& format,
                                     const ForeignOptions& options, Progress& progress)
    : impl_(std::make_unique<Impl>()) {
  Impl& d = *impl_;
  d.path = path;
  d.format = &format;
  d.o = options;
  d.check_options();
  const auto source = d.open();
  ForeignReader& reader = *source;
  if (d.o.origin) d.origin = reader.upright(*d.o.origin);
  SeenBeads seen;
  ForeignFrame s, first;
  while (next_sorted(reader, s)) {
    if (d.n_frames == 0) {
      first = s;
      d.begin(first);
    }
    d.learn(reader, s, first);
    d.follow_steps(reader, s, first);
    seen.add(s, d.o, d.tracer_type(reader.columns()));
    ++d.n_frames;
    progress.update(reader.done(), reader.size());
  }
  if (d.n_frames == 0) throw InputError({path.string(), 0, 0, ""}, "the file holds no frame.");
  d.make_slots(seen);
  d.length_unit = reader.length_unit();
  d.state_assumptions(reader, seen);
  const Vec3 along_y = reader.upright(Vec3(0, 1, 0));
  d.complete(first, reader.columns(), along_y.minCoeff() < 0);
}

ForeignTrajectory::~ForeignTrajectory() = default;

const TrajectoryInfo& ForeignTrajectory::info() const {
  return impl_->info;
}

std::size_t ForeignTrajectory::n_frames() const {
  return impl_->n_frames;
}

bool ForeignTrajectory::is_flat() const {
  return impl_->info.n_beads > 1 && (impl_->flat[0] || impl_->flat[1]);
}

double ForeignTrajectory::missing_frames() const {
  if (!(impl_->step_distance > 0)) return 0;
  return std::floor(impl_->step_range / impl_->step_distance) + 1 - static_cast<double>(impl_->n_frames);
}

const std::vector<std::int64_t>& ForeignTrajectory::ids() const {
  return impl_->ids;
}

std::string ForeignTrajectory::length_unit() const {
  return impl_->length_unit;
}
bool ForeignTrajectory::time_in_seconds() const {
  return impl_->time_in_seconds;
}
std::string ForeignTrajectory::assumption() const {
  return impl_->assumption;
}

bool ForeignTrajectory::replaces_times() const {
  return impl_->replaces_times;
}

double ForeignTrajectory::spacing() const {
  return impl_->spacing;
}

std::size_t ForeignTrajectory::n_beyond() const {
  return impl_->beyond;
}

void ForeignTrajectory::copy_to(TrajectorySink& sink, Progress& progress) const {
  const auto source = impl_->open();
  ForeignReader& reader = *source;
  ForeignFrame s;
  Frame frame;
  std::optional<PeriodCounter> periods;  // the box is that of the first frame
  while (next_sorted(reader, s)) {
    if (!periods) periods.emplace(impl_->wrapping(s, reader.columns()), impl_->ids.size());
    impl_->fill(reader, s, *periods, frame);
    sink.append(frame);
    progress.update(reader.done(), reader.size());
  }
}

}  // namespace twincell
