// twincell calibrate plate STACK: the drive from the edge of the plate.

#include <fmt/format.h>

#include <CLI/CLI.hpp>
#include <cmath>
#include <fstream>
#include <memory>

#include "calibration/drive/accelerometer.hpp"
#include "calibration/drive/drive_fit.hpp"
#include "calibration/drive/drive_fit_figure.hpp"
#include "cli/calibrate.hpp"
#include "cli/number_checks.hpp"
#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/json_text.hpp"
#include "core/plural.hpp"
#include "imaging/stack/frame_source.hpp"

namespace twincell::cli {
namespace {

struct PlateOptions {
  CalibrateFlags flags;
  std::string phases, accelerometer;
  int frames_per_cycle = 0;
  std::optional<double> frame_rate_hz;
};

/// Largest relative difference between frame rates that count as equal. Clocks of cameras differ by less.
constexpr double kSameRate = 0.01;
constexpr const char* kPhaseHeading = "frame,cycles\n";

void write_phases(const std::string& path, const calibration::DriveFit& lock) {
  AtomicPath file(path, Product::table(kPhaseHeading));
  {
    std::ofstream out(file.part());
    out << kPhaseHeading;
    // read_triggers requires cycles that are counted from 0.
    const double first = std::floor(lock.frames.front().cycles);
    for (std::size_t f = 0; f < lock.frames.size(); ++f)
      out << (lock.has_phase(f) ? fmt::format("{},{:.6f}\n", f, lock.frames[f].cycles - first)
                                : fmt::format("{},\n", f));
    if (!out.flush()) throw RunError(path + ": writing the table failed.");
  }
  file.commit();
}

std::string list_of(const calibration::DriveFit& lock, calibration::FrameLock kind) {
  constexpr int kMaxNamed = 12;
  std::string s;
  int n = 0;
  for (std::size_t f = 0; f < lock.frames.size(); ++f)
    if (lock.frames[f].lock == kind && ++n <= kMaxNamed) s += fmt::format("{}{}", n > 1 ? ", " : "", f);
  return n > kMaxNamed ? s + ", ..." : s;
}

calibration::DriveFit lock_of(const PlateOptions& o, const imaging::CellDescription& cell,
                              const calibration::CellGeometry& g, const calibration::StackEdges& edges) {
  try {
    const int known = o.frames_per_cycle > 0 ? o.frames_per_cycle : cell.phase_lock.frames_per_cycle;
    return calibration::fit_drive(g.heights_px(), {.frames_per_cycle = known,
                                                   .mend = true,
                                                   .model_error = calibration::kHeightModelError_px,
                                                   .repeats = edges.repeats});
  } catch (const InputError& e) {
    throw InputError({.file = o.flags.stack, .key = {}}, e.what());
  }
}

/// What the results of this kind are computed from.
struct MeasuredPlate {
  const PlateOptions& options;
  const imaging::CellDescription& cell;
  const calibration::CellGeometry& geometry;
  calibration::DriveFit lock;
  std::optional<KnownNumber> scale;  // pixels per sigma
  std::optional<double> rate;        // frames per second
  std::string data;                  // hash of the stack

  [[nodiscard]] double frequency_hz() const { return lock.omega / (2 * M_PI) * *rate; }
  [[nodiscard]] double frequency_error_hz() const { return lock.omega_error / (2 * M_PI) * *rate; }
};

/// Frames per second; a note where the stack contradicts the rate that was stated.
std::optional<double> rate_of(const PlateOptions& o, const imaging::CellDescription& cell,
                              const calibration::StackEdges& edges, std::vector<std::string>& notes) {
  const std::optional<double> stated = o.frame_rate_hz ? o.frame_rate_hz : cell.frame_rate_hz;
  if (stated)
    if (const auto seen = calibration::frame_rate_of({}, edges, o.flags.stack);
        seen && std::abs(*seen / *stated - 1) > kSameRate)
      notes.push_back(fmt::format(
          "the stack states {:.7g} frames per second, but the given rate of {:.7g} is used", *seen, *stated));
  return calibration::frame_rate_of(stated, edges, o.flags.stack);
}

/// Adds the quantities of camera and drive.
void add_quantities(CalibrationResult& out, const MeasuredPlate& m) {
  const calibration::DriveFit& lock = m.lock;
  const auto add = [&](const std::string& name, double value, double error, const std::string& method) {
    out.measured.push_back(
        {.name = name, .value = {value}, .standard_error = {error}, .method = method, .data = m.data});
  };
  const std::string harmonic = "harmonic fit to the plate's edge in " + plural(lock.locked, "frame");
  if (lock.frames_per_cycle > 0) {
    add("camera.frames_per_cycle", lock.frames_per_cycle, 0, "the nearest whole number to camera.period");
    add("camera.first_phase", lock.first_phase, 0, harmonic);
    add("camera.phase_offset", lock.phase_offset, lock.phase_offset_error, harmonic);
  }
  add("camera.period", lock.period, lock.period_error, harmonic);
  if (lock.jitter)
    add("camera.jitter", *lock.jitter, lock.jitter_error, "scatter that grows with the plate's speed");
  if (m.scale) {
    const double a = lock.amplitude / m.scale->value;
    add("drive.amplitude", a,
        a * std::hypot(lock.amplitude_error / lock.amplitude, m.scale->error.value_or(0) / m.scale->value),
        harmonic + ", scale: " + m.scale->from);
  }
  // The frame interval in t0 converts the frames per cycle to omega.
  if (const auto t0 = m.cell.scale.t0_s(); m.rate && t0)
    add("drive.omega", lock.omega * *m.rate * *t0, lock.omega_error * *m.rate * *t0,
        fmt::format("{}, {:.7g} frames per second", harmonic, *m.rate));
  if (lock.second_harmonic)
    add("drive.second_harmonic", *lock.second_harmonic, *lock.second_harmonic_error, harmonic);
}

/// What the scale leaves open.
void note_scale(CalibrationResult& out, const MeasuredPlate& m) {
  if (!m.scale)
    out.notes.emplace_back(
        "no scale is known, so A is given only in px: state camera.pixels_per_sigma or cell.width in "
        "CELL.toml, or run calibrate camera first");
  else if (!m.scale->error)
    out.notes.emplace_back("the error of drive.amplitude assumes that the cell's scale is exact");
}

/// Adds what only this kind has to the document: the motion of the plate.
void describe_motion(nlohmann::json& d, const MeasuredPlate& m) {
  const calibration::DriveFit& lock = m.lock;
  d["plate"] = {
      {"z0_px", lock.z0},
      {"row_px", m.geometry.plate_row - lock.z0},
      {"amplitude_px", lock.amplitude},
      {"amplitude_error_px", lock.amplitude_error},
      {"omega_per_frame", lock.omega},
      {"omega_error_per_frame", lock.omega_error},
      {"phi", lock.phi},
      {"phi_error", lock.phi_error},
      {"rms_residual_px", lock.rms},
      {"blur_px", m.geometry.blur_px},
      {"rotation_deg", m.geometry.rotation_deg},
      {"p_sinusoidal", lock.p_sinusoidal ? number_or_null(*lock.p_sinusoidal) : nlohmann::json()},
      {"sinusoidal", lock.p_sinusoidal ? nlohmann::json(*lock.p_sinusoidal >= 0.01) : nlohmann::json()},
      {"jitter_limit_frames", lock.jitter_limit}};
  if (m.rate)
    d["plate"]["frequency_hz"] = {{"value", m.frequency_hz()}, {"standard_error", m.frequency_error_hz()}};
}

/// Adds the phase of each frame to the document.
void describe_frames(nlohmann::json& d, const MeasuredPlate& m) {
  const calibration::DriveFit& lock = m.lock;
  d["frames"] = {{"locked", lock.locked},
                 {"out_of_lock", lock.out_of_lock},
                 {"unseen", lock.unseen},
                 {"dropped", lock.dropped},
                 {"doubled", lock.doubled}};
  constexpr const char* kLocks[] = {"locked", "out_of_lock", "unseen"};
  for (std::size_t f = 0; f < lock.frames.size(); ++f)
    d["per_frame"].push_back({{"frame", f},
                              {"tick", lock.frames[f].tick},
                              {"phase", lock.frames[f].cycles - std::floor(lock.frames[f].cycles)},
                              {"height_px", number_or_null(m.geometry.heights[f].height_px)},
                              {"error_px", number_or_null(m.geometry.heights[f].sigma_px)},
                              {"residual_px", number_or_null(lock.frames[f].residual)},
                              {"lock", kLocks[static_cast<std::size_t>(lock.frames[f].lock)]}});
  for (const imaging::FrameStretch& s : lock.out_of_lock_stretches)
    d["frames"]["without_phase"].push_back({s.first, s.last});
}

/// The same as text.
std::string text_of(const MeasuredPlate& m) {
  const calibration::DriveFit& lock = m.lock;
  std::string text = fmt::format(
      "A = {:.4f} +- {:.4f} px about row {:.3f}; rms residual {:.3f} px, edge blur {:.2f} px\n",
      lock.amplitude, lock.amplitude_error, m.geometry.plate_row - lock.z0, lock.rms, m.geometry.blur_px);
  text += fmt::format("frames: {} locked, {} out of lock, {} without a plate, {} dropped, {} doubled\n",
                      lock.locked, lock.out_of_lock, lock.unseen, lock.dropped, lock.doubled);
  if (lock.out_of_lock > 0)
    text += "out of lock: " + list_of(lock, calibration::FrameLock::out_of_lock) + "\n";
  if (!lock.jitter) text += fmt::format("jitter: below {:.2g} frames\n", lock.jitter_limit);
  if (lock.p_sinusoidal)
    text += fmt::format("second harmonic: {:.2g} +- {:.1g} of A, p = {:.2g} for a pure sine\n",
                        *lock.second_harmonic, *lock.second_harmonic_error, *lock.p_sinusoidal);
  return text;
}

/// A omega^2 from the picture next to that of the accelerometer. \pre scale and rate are known
void compare_acceleration(CalibrationResult& out, const MeasuredPlate& m,
                          const calibration::VibrationFit& v) {
  const double f = m.frequency_hz(), e = m.frequency_error_hz(), w = 2 * M_PI * f;
  const double metres = m.lock.amplitude / m.scale->value * *m.cell.scale.sigma_m, seen = metres * w * w;
  const double error =
      seen * std::sqrt(std::pow(m.lock.amplitude_error / m.lock.amplitude, 2) +
                       std::pow(m.scale->error.value_or(0) / m.scale->value, 2) + std::pow(2 * e / f, 2));
  const double z = (seen - v.acceleration) / std::hypot(error, v.acceleration_error);
  out.document["accelerometer"]["acceleration_difference"] = {{"m_s2", seen - v.acceleration},
                                                              {"standard_errors", number_or_null(z)}};
  out.text += fmt::format("  A omega^2: camera {:.5g} +- {:.2g} m/s^2, {:.1f} standard errors apart\n", seen,
                          error, z);
}

/// Comparison with the accelerometer: frequency, and A omega^2 if the scale is known.
void compare_with(const calibration::VibrationTable& vibration, CalibrationResult& out,
                  const MeasuredPlate& m) {
  const calibration::VibrationFit v = calibration::fit_vibration(vibration);
  nlohmann::json& d = out.document["accelerometer"];
  d = {{"frequency_hz", {{"value", v.frequency_hz}, {"standard_error", v.frequency_error}}},
       {"acceleration", {{"value", v.acceleration}, {"standard_error", v.acceleration_error}}}};
  out.text += fmt::format("accelerometer: {:.6g} +- {:.2g} Hz, amplitude {:.5g} +- {:.2g} m/s^2\n",
                          v.frequency_hz, v.frequency_error, v.acceleration, v.acceleration_error);
  out.notes.insert(out.notes.end(), v.doubts.begin(), v.doubts.end());
  if (!m.rate) {
    out.notes.emplace_back("without a frame rate (--frame-rate-hz) the accelerometer cannot be compared");
    return;
  }
  const double apart = m.frequency_hz() - v.frequency_hz;
  const double z = apart / std::hypot(m.frequency_error_hz(), v.frequency_error);
  d["frequency_difference"] = {{"hz", apart}, {"standard_errors", number_or_null(z)}};
  out.text +=
      fmt::format("  frequency: camera - accelerometer = {:.2g} Hz, {:.1f} standard errors\n", apart, z);
  if (m.scale && m.cell.scale.sigma_m) compare_acceleration(out, m, v);
}

void run(const PlateOptions& o, const Common& common) {
  const imaging::CellDescription cell = filmed_cell(o.flags, common);
  const std::optional<calibration::VibrationTable> vibration =
      o.accelerometer.empty() ? std::nullopt : std::optional(calibration::read_vibration(o.accelerometer));
  calibration::StackEdges edges;
  const calibration::CellGeometry g = geometry_of(o.flags, cell, common, edges);
  MeasuredPlate m{o, cell, g, lock_of(o, cell, g, edges), scale_of(cell, g), {}, data_hash(o.flags.stack)};
  calibration::DriveFit& lock = m.lock;
  lock.amplitude_error = std::hypot(lock.amplitude_error, lock.amplitude * g.stretch_error);

  CalibrationResult out;
  out.notes = lock.notes;
  note_scale(out, m);
  m.rate = rate_of(o, cell, edges, out.notes);
  add_quantities(out, m);
  out.document["stack"] = o.flags.stack;
  describe_motion(out.document, m);
  describe_frames(out.document, m);
  out.text = text_of(m);
  if (lock.dropped + lock.doubled > 0)
    out.notes.emplace_back(
        "frames are missing or doubled: write a list with --phases, and use it with track --phase-lock");
  if (vibration) compare_with(*vibration, out, m);
  if (!o.phases.empty()) {
    write_phases(o.phases, lock);
    out.document["phases"] = o.phases;
    out.text += o.phases + "\n";
  }
  out.figures = {calibration::drive_fit_figure(lock)};
  finish_calibration(o.flags, common, std::move(out));
}

}  // namespace

void add_calibrate_plate(CLI::App& calibrate, Common& common) {
  auto o = std::make_shared<PlateOptions>();
  CLI::App& verb = add_verb(calibrate, common, "plate",
                            "Measure the drive and the phase of each frame from the edge of the plate. "
                            "Prints them; -o also writes them to a calibration file.",
                            "twincell calibrate plate frames/ --cell CELL.toml -o cell.calibration.toml");
  add_stack_flags(verb, common, o->flags, "plate");
  verb.add_option("--frames-per-cycle", o->frames_per_cycle,
                  "Frames per drive cycle at which the search for the period starts; default: the value in "
                  "CELL.toml, otherwise searched for")
      ->check(CLI::Range(2, 100000));
  former_option(verb, "--fps", "--frame-rate-hz");
  verb.add_option("--frame-rate-hz", o->frame_rate_hz,
                  "Frame rate, 1/s; default: the value in CELL.toml, otherwise that of the stack")
      ->check(above_zero());
  writes(common, verb,
         verb.add_option("--phases", o->phases,
                         "List of the phase of each frame to write (CSV), for track --phase-lock"),
         Product::table(kPhaseHeading));
  verb.add_option(
      "--accelerometer", o->accelerometer,
      "Measurement of an accelerometer to compare with: CSV with the columns time_s and acceleration_m_s2");
  verb.callback([o, &common] { run(*o, common); });
}

}  // namespace twincell::cli
