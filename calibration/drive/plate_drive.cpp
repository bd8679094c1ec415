#include "calibration/drive/plate_drive.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <complex>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "calibration/camera/cell_geometry.hpp"
#include "calibration/drive/drive_fit.hpp"
#include "core/constants.hpp"
#include "core/error.hpp"
#include "imaging/stack/open_frames.hpp"
#include "trajectory/tracking_record.hpp"

namespace twincell::calibration {
namespace {

/// Whether a quantity of the drive other than the amplitude is stated.
bool states_more_than_amplitude(const DriveSpec& s) {
  return s.omega || s.frequency || s.gamma || s.k_m || s.peak_velocity;
}

/// Pixels per sigma: as stated, else from the distance of the walls.
double scale_of(const imaging::CellDescription& cell, const CellGeometry& geometry, const Where& where) {
  if (cell.pixels_per_sigma) return *cell.pixels_per_sigma;
  if (cell.width && geometry.has_left && geometry.has_right) return geometry.width_px() / *cell.width;
  throw ConfigError(where,
                    "is not stated, and the plate's motion gives it only in pixels: state "
                    "camera.pixels_per_sigma, or cell.width if both walls are in the picture.");
}

imaging::BeadsAtEdges beads_at_edges(const imaging::CellDescription& cell,
                                     const std::filesystem::path& stack) {
  return {.bright = cell.bright,
          .diameter_px = diameter_for_edges(stack, cell.bright, cell.pixels_per_sigma.value_or(0)),
          .refine = cell.refine.value_or(imaging::BeadsAtEdges{}.refine)};
}

/// Plate edge and its motion. If the plate is outside the picture, the detection may return the lowest row of
/// beads or the picture's border instead, so the edge is checked. \throws InputError if no edge moves as a
/// plate does, or if the edge is more than half a bead from the stated position of the plate
std::pair<CellGeometry, DriveFit> plate_in_picture(const imaging::CellDescription& cell,
                                                   const StackEdges& edges) {
  const CellGeometry geometry = fit_cell_geometry(edges);
  const DriveFit drive =
      fit_drive(geometry.heights_px(), {.frames_per_cycle = cell.phase_lock.frames_per_cycle,
                                        .mend = true,
                                        .model_error = kHeightModelError_px,
                                        .repeats = edges.repeats});
  if (cell.origin && cell.pixels_per_sigma) {
    constexpr double kMaxDistance = 0.5;  // sigma
    const double row = geometry.plate_row - drive.z0;
    if (std::abs(row - cell.origin->y_px) > kMaxDistance * *cell.pixels_per_sigma)
      throw InputError({}, fmt::format("the lowest edge in the picture is at row {:.1f}, but the plate, by "
                                       "camera.origin_px, is at row {:.1f}",
                                       row, cell.origin->y_px));
  }
  return {geometry, drive};
}

}  // namespace

bool lacks_drive(const imaging::CellDescription& cell, bool phases) {
  return !is_whole(cell.drive_spec) || (phases && !cell.phase_lock.locked());
}

CompletedDrive complete_drive(imaging::CellDescription cell, bool phases,
                              const std::filesystem::path& cell_file, const std::filesystem::path& stack,
                              const imaging::FrameRange& range, int threads, Progress& progress) {
  const auto where = [&](const char* key) { return Where{.file = cell_file.string(), .key = key}; };
  const StackEdges edges = read_stack_edges(*imaging::chosen_frames(imaging::open_frames(stack), range),
                                            beads_at_edges(cell, stack), threads, progress);
  const auto seen = [&] {
    try {
      return plate_in_picture(cell, edges);
    } catch (const InputError& e) {
      throw InputError({.file = stack.string()},
                       fmt::format("the drive is not stated, and cannot be seen on the plate: {}", e.what()));
    }
  }();
  const auto& [geometry, lock] = seen;
  std::string said = "by the plate's edge:";
  DriveSpec& spec = cell.drive_spec;
  if (!is_whole(spec)) {
    if (!spec.amplitude) {
      const double scale = scale_of(cell, geometry, where("drive.amplitude"));
      spec.amplitude = lock.amplitude / scale;
      said += fmt::format(" A = {:.5g} +- {:.2g} sigma", *spec.amplitude, lock.amplitude_error / scale);
    }
    if (!states_more_than_amplitude(spec)) {
      const auto rate = frame_rate_of(cell.frame_rate_hz, edges, stack, range);
      const auto t0 = cell.scale.t0_s();
      if (!rate || !t0)
        throw ConfigError(
            where("drive.omega"),
            fmt::format("is not stated, and the plate's motion gives it only per frame: state it, or {}.",
                        !rate ? "camera.frame_rate_hz" : "scale.sigma_m and gravity_m_s2"));
      spec.omega = lock.omega * *rate * *t0;
      said += fmt::format("{} omega = {:.6g} +- {:.2g} /t0", said.back() == ':' ? "" : ",", *spec.omega,
                          lock.omega_error * *rate * *t0);
    }
  }
  if (phases && !cell.phase_lock.locked()) {
    if (lock.frames_per_cycle == 0)
      throw ConfigError(
          where("camera.frames_per_cycle"),
          fmt::format("is missing, and the plate's period of {:.5g} frames is not a whole number "
                      "over the stack, so the frames have no fixed phases; --phase-lock found takes "
                      "them from the plate.",
                      lock.period));
    cell.phase_lock = {lock.frames_per_cycle, lock.first_phase, lock.phase_offset};
    said += fmt::format("{} {} frames per cycle, the first at phase {}", said.back() == ':' ? "" : ",",
                        lock.frames_per_cycle, lock.first_phase);
  }
  return {std::move(cell), std::move(said)};
}

namespace {

/// The first of the chosen frames of a stack, at most `most`.
class FirstFrames : public imaging::FrameSource {
 public:
  FirstFrames(const std::filesystem::path& stack, const imaging::FrameRange& range, std::size_t most)
      : all_(imaging::chosen_frames(imaging::open_frames(stack), range)), most_(most), left_(most) {}
  bool next(cv::Mat& frame) override {
    if (left_ == 0) return false;
    --left_;
    return all_->next(frame);
  }
  [[nodiscard]] std::size_t announced() const override { return std::min(all_->announced(), most_); }
  [[nodiscard]] std::string current() const override { return all_->current(); }
  [[nodiscard]] imaging::StackInfo info() const override { return all_->info(); }
  [[nodiscard]] std::optional<double> time_s() const override { return all_->time_s(); }

 private:
  std::unique_ptr<imaging::FrameSource> all_;
  std::size_t most_, left_;
};

/// Largest difference of a measured and a stated number: standard errors, fraction of the stated one, px.
constexpr double kMaxStandardErrors = 5, kMaxRelativeDifference = 0.03, kMaxDifference_px = 0.3;
/// The bed's lower surface departs from the plate by up to 4 % of A (recovery.BedDrive), because of landings
/// and of beads that are pushed up.
constexpr double kMaxRelativeDifferenceOfBed = 0.1;

/// Whether a stated number is a usual multiple of a measured one.
bool is_about(double stated, double multiple) {
  constexpr double kAbout = 0.04;
  return std::abs(stated - multiple) < kAbout * multiple;
}

/// Compares the measured amplitude in `check` with the stated one.
void compare_amplitude(DriveCheck& check, const std::string& what, double stated, double share,
                       double scale) {
  if (std::abs(check.amplitude - stated) >
      std::max({kMaxStandardErrors * check.amplitude_error, share * stated, kMaxDifference_px / scale}))
    check.disagreement =
        fmt::format("{} moves with A = {:.4g} +- {:.2g} sigma, but the cell states {:.4g}{}", what,
                    check.amplitude, check.amplitude_error, stated,
                    is_about(stated, 2 * check.amplitude) ? ", twice as much, as from peak to peak" : "");
}

/// Notes a difference that compare_amplitude() lets pass, where it is far beyond the errors of a plate's
/// edge. Numbers that depend on A then differ by as much from those of the film.
void doubt_amplitude(DriveCheck& check, double stated, double scale) {
  constexpr double kNotableShare = 0.005, kNotable_px = 0.05;
  const double off = std::abs(check.amplitude - stated);
  if (!check.disagreement.empty() || off <= std::max({kMaxStandardErrors * check.amplitude_error,
                                                      kNotableShare * stated, kNotable_px / scale}))
    return;
  check.doubt = fmt::format(
      "the plate in the frames moves with A = {:.4g} +- {:.2g} sigma, and the cell states {:.4g}, which is "
      "{:.2g} errors away: correct drive.amplitude or camera.pixels_per_sigma",
      check.amplitude, check.amplitude_error, stated, off / check.amplitude_error);
}

void compare_omega(DriveCheck& check, const std::string& what, const DriveFit& seen, double stated,
                   const std::optional<double>& t0) {
  if (!check.frame_rate_hz || !t0 || !check.disagreement.empty()) return;
  const double omega = seen.omega * *check.frame_rate_hz * *t0,
               error = seen.omega_error * *check.frame_rate_hz * *t0;
  if (std::abs(omega - stated) > std::max(kMaxStandardErrors * error, kMaxRelativeDifference * stated))
    check.disagreement =
        fmt::format("{} moves with omega = {:.4g} +- {:.2g} per t0, but the cell states {:.4g}{}", what,
                    omega, error, stated,
                    is_about(stated, 2 * M_PI * omega) ? ", 2 pi times as much, as from rad/s taken for Hz"
                    : is_about(stated, omega / (2 * M_PI)) ? ", 1/(2 pi) of it, as from Hz taken for rad/s"
                                                           : "");
}

/// Compares the second harmonic with the stated one, or with none, as vectors of amplitude and phase.
void compare_harmonic(DriveCheck& check, const std::string& what, const DriveFit& seen, const Drive& stated) {
  constexpr double kMaxHarmonicDifference = 0.03;  // of A; its acceleration is four times as large
  if (!seen.second_harmonic || stated.recorded || !check.disagreement.empty()) return;
  const Harmonic second = stated.harmonics.empty() ? Harmonic{} : stated.harmonics.front();
  const std::complex<double> there = std::polar(*seen.second_harmonic, kTurn * *seen.second_harmonic_phase),
                             said = std::polar(second.amplitude, kTurn * second.phase);
  if (std::abs(there - said) <=
      std::max(kMaxHarmonicDifference, kMaxStandardErrors * *seen.second_harmonic_error))
    return;
  const std::string cell = second.amplitude > 0
                               ? fmt::format("states {:.3g} at phase {:.2g}", second.amplitude, second.phase)
                               : std::string("states none");
  check.disagreement = fmt::format(
      "{} has a second harmonic of {:.3g} +- {:.1g} of A at phase {:.2g}, but the cell {} (drive.harmonics)",
      what, *seen.second_harmonic, *seen.second_harmonic_error, *seen.second_harmonic_phase, cell);
}

/// The period is known in frames, without a frame rate and a scale.
void compare_period(DriveCheck& check, const std::string& what, const DriveFit& seen, int stated) {
  if (stated <= 0 || !check.disagreement.empty()) return;
  if (std::abs(seen.period - stated) >
      std::max(kMaxStandardErrors * seen.period_error, kMaxRelativeDifference * stated))
    check.disagreement = fmt::format(
        "{} moves with a period of {:.4g} +- {:.2g} frames, but the cell states {} frames per cycle", what,
        seen.period, seen.period_error, stated);
}

/// The stated frame rate and frames per cycle give a frequency without any frame. The
/// playback rate of a video is not the camera's, so only a stated rate counts.
void compare_frame_rate(DriveCheck& check, const imaging::CellDescription& cell,
                        const imaging::FrameRange& range, double stated) {
  const auto t0 = cell.scale.t0_s();
  if (!cell.frame_rate_hz || !t0 || !cell.phase_lock.locked() || !check.disagreement.empty()) return;
  const std::int64_t per_cycle = cell.phase_lock.frames_per_cycle * range.step;  // of the whole stack
  const double omega = 2 * M_PI * *cell.frame_rate_hz * *t0 / static_cast<double>(per_cycle);
  if (std::abs(omega - stated) > kMaxRelativeDifference * stated)
    check.disagreement = fmt::format(
        "{:g} frames per second and {} frames per cycle give omega = {:.4g} per t0, but the cell states "
        "{:.4g}",
        *cell.frame_rate_hz, per_cycle, omega, stated);
}

/// Motion of the plate. A fit that begins at a wrong number of frames per cycle fails or ends beside the true
/// period, so that a second one searches for the period and is kept if it describes the heights as well. It
/// needs the stated position of the plate, because without the plate in the picture it would find a period in
/// the noise of another edge.
DriveFit motion_of_plate(const imaging::CellDescription& cell, const StackEdges& edges) {
  if (!cell.phase_lock.locked() || !cell.origin) return plate_in_picture(cell, edges).second;
  imaging::CellDescription free = cell;
  free.phase_lock = {};
  const auto fitted = [&](const imaging::CellDescription& from) -> std::optional<DriveFit> {
    try {
      return plate_in_picture(from, edges).second;
    } catch (const InputError&) {
      return {};
    }
  };
  const auto as_stated = fitted(cell);
  if (!as_stated) return plate_in_picture(free, edges).second;
  const auto searched = fitted(free);
  constexpr double kMaxRmsRatio = 1.1;  // of the fit with a searched period to that with the stated one
  return searched && searched->locked >= as_stated->locked && searched->rms <= kMaxRmsRatio * as_stated->rms
             ? *searched
             : *as_stated;
}

/// Whether the stated position of the plate is in the picture, and further from the seen one than a rotation
/// of the camera explains. A bed that lies on a plate out of the picture moves as that plate does.
bool is_misplaced(const imaging::CellDescription& cell, const CellGeometry& geometry, double row) {
  constexpr double kMaxDistance = 2;  // bead diameters
  const double stated = cell.origin->y_px, turned = std::abs(std::sin(geometry.rotation_deg * M_PI / 180));
  return stated < geometry.size.height &&
         std::abs(row - stated) > kMaxDistance * *cell.pixels_per_sigma + turned * geometry.size.width;
}

/// The cell file of another stack, or a wrong origin: an edge follows a sine as cleanly as only a plate does,
/// but not where the cell states the plate. A bed whose plate is out of the picture follows no clean sine
/// while it flies, and has the amplitude of the plate while it lies on it.
void look_for_plate_elsewhere(DriveCheck& check, const imaging::CellDescription& cell,
                              const StackEdges& edges, double stated) {
  constexpr double kMaxRms = 0.02;          // fraction of the amplitude
  constexpr double kMinLockedShare = 0.95;  // of the frames
  constexpr double kMinAmplitude_px = 1;
  if (!cell.origin) return;
  imaging::CellDescription anywhere = cell;
  anywhere.origin.reset();
  anywhere.phase_lock = {};
  try {
    const auto [geometry, seen] = plate_in_picture(anywhere, edges);
    if (seen.amplitude < kMinAmplitude_px || seen.rms > kMaxRms * seen.amplitude ||
        static_cast<double>(seen.locked) < kMinLockedShare * static_cast<double>(geometry.heights.size()))
      return;
    const double scale = *cell.pixels_per_sigma, row = geometry.plate_row - seen.z0;
    DriveCheck found;
    found.amplitude = seen.amplitude / scale;
    found.amplitude_error = seen.amplitude_error / scale;
    compare_amplitude(
        found,
        fmt::format("the plate in the frames, at row {:.1f} where camera.origin_px states {:.1f},", row,
                    cell.origin->y_px),
        stated, kMaxRelativeDifference, scale);
    check.plate_elsewhere = found.disagreement;
    check.amplitude = found.amplitude;
    check.amplitude_error = found.amplitude_error;
    if (!found.disagreement.empty() || !is_misplaced(cell, geometry, row)) return;
    check.by = "plate";
    check.not_comparable.clear();
    check.disagreement =
        fmt::format("the plate in the frames is at row {:.1f}, but camera.origin_px states row {:.1f}", row,
                    cell.origin->y_px);
  } catch (const InputError&) {  // no edge moves as a plate does
  }
}

}  // namespace

nlohmann::json report_of(const DriveCheck& check) {
  nlohmann::json members;
  if (check.by.empty())
    members["drive_check"] = {{"not_comparable", check.not_comparable}};
  else
    members["drive_check"] = {
        {"by", check.by}, {"amplitude", check.amplitude}, {"amplitude_error", check.amplitude_error}};
  if (!check.disagreement.empty()) members["drive_disagreement"] = check.disagreement;
  return members;
}

DriveCheck check_by_plate(const imaging::CellDescription& cell, const std::filesystem::path& stack,
                          const imaging::FrameRange& range, int threads, Progress& progress,
                          bool fixed_phases) {
  DriveCheck check;
  const auto drive = cell.drive();
  if (!drive || !cell.pixels_per_sigma) {
    check.not_comparable = drive ? "the cell states no scale" : "the cell states no drive";
    return check;
  }
  const double scale = *cell.pixels_per_sigma;
  // Three cycles determine the amplitude; reading all of a long film would cost as much as locating its
  // beads.
  constexpr std::size_t kCyclesRead = 3, kMinFrames = 40;
  FirstFrames beginning(
      stack, range,
      std::max(kMinFrames, kCyclesRead * static_cast<std::size_t>(cell.phase_lock.frames_per_cycle)));
  const StackEdges edges = read_stack_edges(beginning, beads_at_edges(cell, stack), threads, progress);
  check.frame_rate_hz = frame_rate_of(cell.frame_rate_hz, edges, stack, range);
  try {
    const DriveFit seen = motion_of_plate(cell, edges);
    check.by = "plate";
    check.amplitude = seen.amplitude / scale;
    check.amplitude_error = seen.amplitude_error / scale;
    const std::string what = "the plate in the frames";
    compare_amplitude(check, what, drive->amplitude, kMaxRelativeDifference, scale);
    doubt_amplitude(check, drive->amplitude, scale);
    if (fixed_phases) compare_period(check, what, seen, cell.phase_lock.frames_per_cycle);
    compare_omega(check, what, seen, drive->omega, cell.scale.t0_s());
    compare_harmonic(check, what, seen, *drive);
  } catch (const InputError& e) {  // no plate in the picture, or it does not move
    check.not_comparable = without_full_stop(e.what());
    look_for_plate_elsewhere(check, cell, edges, drive->amplitude);
  }
  if (fixed_phases) compare_frame_rate(check, cell, range, drive->omega);
  return check;
}

namespace {

/// \param shift frames by which the bed is later in the cycle than its phases state
std::string phase_disagreement(int shift, const TrajectoryInfo& info) {
  const int n = info.phases_per_cycle;
  if (const std::optional<int> stated = tracked_first_phase(info))
    return fmt::format(
        "the bed on its plate shows the first frame at phase {} of {}, the stated first phase is {} "
        "(camera.first_phase, --first-phase)",
        ((*stated + shift) % n + n) % n, n, *stated);
  return fmt::format("the bed on its plate is {} of {} phases {} in the cycle than stated", std::abs(shift),
                     n, shift > 0 ? "later" : "earlier");
}

}  // namespace

DriveCheck check_by_bed(const BedSteps& bed, const TrajectoryInfo& info,
                        std::optional<double> frame_rate_hz) {
  DriveCheck check;
  check.frame_rate_hz = frame_rate_hz;
  const BedDrive seen = drive_of_bed(bed, info);
  if (!seen.not_comparable.empty()) {
    check.not_comparable = seen.not_comparable;
    return check;
  }
  check.by = "bed";
  check.amplitude = seen.amplitude;
  check.amplitude_error = seen.amplitude_error;
  check.disagreement = seen.contradiction;
  if (!check.disagreement.empty()) return check;
  const std::string what = "the bed on its plate";
  if (seen.phase_shift != 0) {
    check.disagreement = phase_disagreement(seen.phase_shift, info);
    return check;
  }
  compare_amplitude(check, what, info.drive->amplitude, kMaxRelativeDifferenceOfBed,
                    info.scale.pixels_per_sigma.value_or(1e9));
  try {
    std::vector<double> heights = {0};
    for (const BedSteps::Step& step : bed.steps()) heights.push_back(heights.back() + step.dz);
    compare_omega(check, what, fit_drive(heights, {.frames_per_cycle = info.phases_per_cycle, .mend = false}),
                  info.drive->omega, info.scale.t0_s());
  } catch (const InputError&) {  // the amplitude was found, the period cannot be fitted
  }
  return check;
}

DriveCheck check_by_bed(const BedSteps& bed, const TrajectoryInfo& info, const DriveCheck& by_plate) {
  DriveCheck check = check_by_bed(bed, info, by_plate.frame_rate_hz);
  if (!check.by.empty() || by_plate.plate_elsewhere.empty()) return check;
  check.by = "plate";
  check.amplitude = by_plate.amplitude;
  check.amplitude_error = by_plate.amplitude_error;
  check.disagreement = by_plate.plate_elsewhere;
  return check;
}

}  // namespace twincell::calibration
