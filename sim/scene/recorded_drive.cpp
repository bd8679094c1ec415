#include "sim/scene/recorded_drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <memory>
#include <utility>

#include "core/constants.hpp"
#include "core/error.hpp"
#include "trajectory/read_motion_record.hpp"
#include "trajectory/record_doubts.hpp"

namespace twincell::sim {

namespace {

/// The angular frequency that the keys state; 0 if they state none.
double stated_omega(const DriveSpec& spec) {
  return spec.omega.value_or(kTurn * spec.frequency.value_or(0));
}

/// Number of cycles of a record that is repeated. \param omega 0: one cycle
int cycles_in(const MotionRecord& record, double omega, const Where& where) {
  constexpr double kTolerance = 0.01;
  const double lasts =
      omega > 0 ? static_cast<double>(record.values.size()) * record.interval * omega / kTurn : 1;
  const double cycles = std::max(1.0, std::round(lasts));
  if (std::abs(lasts / cycles - 1) > kTolerance)
    throw ConfigError(
        where, fmt::format("{} has {:.4g} cycles of the stated frequency; a record can be repeated only "
                           "if it has a whole number of cycles (within {:g} %).",
                           record.file, lasts, 100 * kTolerance));
  return static_cast<int>(cycles);
}

/// A sentence about a Gamma at which no bed is usually shaken, as follows from values in another unit;
/// otherwise empty.
std::string doubt_of_strength(double gamma) {
  constexpr double kWeakest = 0.3, kStrongest = 9;
  if (gamma >= kWeakest && gamma <= kStrongest) return {};
  return fmt::format(
      "Gamma = {:.3g} follows from the values, and beds are usually shaken at {:g} to {:g}; is "
      "their unit right?",
      gamma, kWeakest, kStrongest);
}

/// The cutoff if it can remove noise and keeps the sine of the drive.
double admitted(double cutoff, double omega, const MotionRecord& record, const Where& where) {
  constexpr double kMinCutoffRatio = 2;  // cutoff over frequency of the drive
  const double frequency = omega / kTurn, rate = 1 / record.interval;
  if (!(cutoff >= kMinCutoffRatio * frequency))
    throw ConfigError(
        where,
        fmt::format("{:.4g}/t0 would weaken the drive, whose frequency is {:.4g}/t0; it must be at least "
                    "{:g} times as high.",
                    cutoff, frequency, kMinCutoffRatio));
  if (!(cutoff < rate / 2))
    throw ConfigError(where,
                      fmt::format("{:.4g}/t0 removes nothing: it must be below half the sampling rate of {}, "
                                  "{:.4g}/t0.",
                                  cutoff, record.file, rate / 2));
  return cutoff;
}

}  // namespace

Drive recorded_drive(const DriveRecord& record, DriveSpec spec, double gravity, const Scale& scale,
                     const ConfigSection& drive, Axis axis) {
  double omega = stated_omega(spec);
  if (omega == 0 && !record.repeats)
    throw ConfigError(drive.where("file"),
                      "needs drive.frequency or drive.omega too: frames and phases are counted in cycles.");
  MotionRecord read = read_motion_record(record.file, scale, drive.where("file"));
  if (!record.sha256.empty() && record.sha256 != read.sha256)
    throw InputError({.file = read.file, .key = {}},
                     fmt::format("has the SHA-256 {}, but drive.file_sha256 is {}: the record has changed.",
                                 read.sha256, record.sha256));
  const bool scaled = spec.amplitude || spec.gamma || spec.k_m || spec.peak_velocity;
  std::vector<std::string> doubts = {doubt_of_clipping(read.values)};
  if (read.derivative == 2 && !scaled) doubts.push_back(doubt_of_unit(read.values));
  int cycles = 0;
  if (record.repeats) {
    cycles = cycles_in(read, omega, drive.where("repeat"));
    // The frequency of the record replaces the stated one, so that its repetitions join.
    omega = kTurn * cycles / (static_cast<double>(read.values.size()) * read.interval);
    spec.omega = omega;
    spec.frequency.reset();
  }
  if (record.cutoff > 0)
    read = smoothed(read, admitted(record.cutoff, omega, read, drive.where("cutoff")), record.repeats);
  FittedMotion fit = fit_motion(read, omega, cycles);
  if (!scaled) spec.amplitude = fit.amplitude;
  Drive solved = solve_drive(spec, gravity, drive.where(""), axis);
  if (scaled && !(fit.amplitude > 0))
    throw ConfigError(
        drive.where("file"),
        fmt::format("{} has no motion at the stated frequency that could be scaled to A = {:g} sigma.",
                    read.file, solved.amplitude));
  if (!scaled && gravity > 0) doubts.push_back(doubt_of_strength(solved.gamma()));
  for (const std::string& doubt : doubts)
    if (!doubt.empty())
      fit.motion.doubt(fmt::format("{} of {}: {}", read.column, fit.motion.info().file, doubt));
  solved.recorded = std::make_shared<RecordedMotion>(
      scaled ? fit.motion.scaled(solved.amplitude / fit.amplitude) : std::move(fit.motion));
  return solved;
}

double share_of_sine(const Drive& drive) {
  const RecordInfo& info = drive.recorded->info();
  double all = 0, rest = 0;
  for (std::size_t k = 0; k < drive.recorded->samples().size(); ++k) {
    const double z = drive.recorded->samples()[k].z, t = static_cast<double>(k) * info.interval - info.start;
    all += z * z;
    rest += std::pow(z - drive.amplitude * std::sin(drive.omega * t), 2);
  }
  return all > 0 ? 1 - rest / all : 0;
}

void require_record_lasts(const Drive& drive, std::int64_t cycles, const Where& where) {
  if (!drive.recorded) return;
  constexpr double kRounding = 1e-6;
  const double lasts = drive.recorded->length(drive.period());
  if (static_cast<double>(cycles) <= lasts + kRounding) return;
  throw ConfigError(
      where,
      fmt::format("{} lasts {:.4g} cycles from its first phase 0, but the run needs {} (a ramp or schedule, "
                  "time.discard and time.cycles); shorten the run, or set drive.repeat = true.",
                  drive.recorded->info().file, lasts, cycles));
}

namespace {

/// The name of Drive::peak_fall, which is downward only along z.
std::string fall_in_words(const Drive& drive) {
  if (drive.axis == Axis::z) return "downward acceleration";
  return fmt::format("acceleration along -{}", "xyz"[static_cast<int>(drive.axis)]);
}

/// The end of the ramp and the strength of the horizontal motion.
std::string changes_in_words(const Drive& drive, double g) {
  std::string text;
  if (drive.horizontal) {
    const double omega = drive.horizontal->ratio * drive.omega;
    text +=
        fmt::format(", along x X (n omega)^2/g = {:.6g}", drive.horizontal->amplitude * omega * omega / g);
  }
  if (drive.ramp) {
    const DriveLevel& to = drive.ramp->to;
    text += fmt::format(" before the ramp, {:.6g} at its {}; {} {} linear in time",
                        to.amplitude * to.omega * to.omega / g, drive.ramp->returns ? "turn" : "end",
                        drive.ramp->linear_quantity(),
                        drive.ramp->changes_frequency() ? "and the frequency are" : "is");
  }
  return text;
}

}  // namespace

std::string beyond_the_sine(const Drive& drive, double gravity) {
  const double g = gravity > 0 ? gravity : 1;
  if (drive.recorded) {
    const RecordInfo& info = drive.recorded->info();
    const RecordedMotion::Range& range = drive.recorded->range();
    return fmt::format(
        " of its sine A = {:.6g} sigma ({:.3g} % of its mean square), {} samples every {:.4g} t0, "
        "displacement {:.4g} to {:.4g} sigma, largest {} {:.6g} g",
        drive.amplitude, 100 * share_of_sine(drive), drive.recorded->samples().size(), info.interval,
        range.lowest, range.highest, fall_in_words(drive), range.fall / g);
  }
  const std::string changes = changes_in_words(drive, g);
  if (drive.harmonics.empty()) return changes;
  return fmt::format(" of the first harmonic, largest {} {:.6g} g{}", fall_in_words(drive),
                     drive.peak_fall() / g, changes);
}

std::vector<std::string> warnings_of_record(const Drive& drive) {
  if (!drive.recorded) return {};
  std::vector<std::string> all = drive.recorded->info().doubts;
  constexpr double kHardlyASine = 0.5, kNoisy = 10;
  const std::string& name = drive.recorded->info().file;
  if (const double share = share_of_sine(drive); share < kHardlyASine) {
    all.push_back(fmt::format(
        "a sine of the stated frequency has only {:.2g} % of the mean square of {}: Gamma, K_m and "
        "the phases of the cycles describe this motion badly; is the frequency right?",
        100 * share, name));
    return all;
  }
  const RecordedMotion::Range& range = drive.recorded->range();
  const double largest = std::max(range.rise, range.fall),
               of_sine = drive.amplitude * drive.omega * drive.omega;
  if (largest > kNoisy * of_sine)
    all.push_back(fmt::format(
        "the largest acceleration of {} is {:.3g} times that of its sine; if this is noise of the "
        "instrument, set drive.cutoff, because the beads feel it.",
        name, largest / of_sine));
  return all;
}

}  // namespace twincell::sim
