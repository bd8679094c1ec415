// Films a trajectory: selects the frames that are stored, and writes their pictures and records.

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <optional>

#include "core/atomic_file.hpp"
#include "core/error.hpp"
#include "core/in_parallel.hpp"
#include "imaging/camera/movie.hpp"
#include "imaging/camera/random.hpp"
#include "imaging/camera/synthetic_camera.hpp"
#include "imaging/codecs/codecs.hpp"
#include "trajectory/boundary_words.hpp"
#include "trajectory/plate.hpp"

namespace twincell::imaging {

namespace {

// The box of a simulation is much taller than its beads reach; a picture of all of it would be mostly empty.
double height_of_beads(const TrajectorySource& trajectory, Progress& progress) {
  constexpr double kHeadroom = 2;
  double top = 0;
  Frame frame;
  for (std::size_t f = 0; f < trajectory.n_frames(); ++f) {
    trajectory.read(f, frame);
    for (std::size_t k = 0; k < frame.position.size(); ++k)
      if (frame.present(k) && std::isfinite(frame.position[k].z()))
        top = std::max(top, frame.position[k].z());
    progress.update(0, static_cast<std::int64_t>(trajectory.n_frames()));
  }
  return std::min(trajectory.info().box.size().z(), top + kHeadroom);
}

// A trigger error larger than the interval between frames would store frames in the wrong order, and a longer
// exposure than that would need paths that the trajectory does not contain.
void check_times(const TrajectorySource& trajectory, const CameraOptions& options) {
  const std::optional<Drive>& drive = trajectory.info().drive;
  double interval = std::numeric_limits<double>::infinity();
  if (trajectory.n_frames() > 1) {
    Frame first, second;
    trajectory.read(0, first);
    trajectory.read(1, second);
    interval = second.time - first.time;
  }
  const double most = std::abs(options.trigger_offset) + 4 * options.trigger_jitter;
  if (most > interval)
    throw ConfigError(
        Where{.file = {}, .key = options.trigger_jitter > 0 ? "trigger-jitter" : "trigger-offset"},
        fmt::format(
            "moves pictures by up to {:.4g} t0 (four standard deviations); the frames are {:.4g} t0 apart.",
            most, interval));
  // Between frames that are farther apart the paths are not known.
  constexpr double kOfPeriod = 1.0 / 8;
  const double longest = drive ? std::min(interval, kOfPeriod * drive->period()) : interval;
  if (options.exposure > longest * (1 + 1e-6))
    throw ConfigError(Where{.file = {}, .key = "exposure"},
                      fmt::format("of {:.4g} t0 is longer than {:.4g} t0, {}.", options.exposure, longest,
                                  longest < interval ? "an eighth of the period of the drive"
                                                     : "the time from frame to frame"));
}

/// The files of a film state one drive, which moves the plate along z, and its side walls do not move.
void check_drive(const TrajectorySource& trajectory) {
  const std::optional<Drive>& drive = trajectory.info().drive;
  if (drive && drive->ramp)
    throw ConfigError(Where{.file = trajectory.name(), .key = "drive.ramp"},
                      "the drive changes during the run, but a film and its CELL.toml have one drive; `draw` "
                      "draws such a run.");
  if (drive && drive->horizontal)
    throw ConfigError(
        Where{.file = trajectory.name(), .key = "drive.horizontal"},
        "the cell also moves along x, but the walls of a film do not; `draw` draws such a run.");
  if (drive && drive->axis != Axis::z)
    throw ConfigError(Where{.file = trajectory.name(), .key = "drive.axis"},
                      fmt::format("the cell moves along {}, but the walls of a film do not, and a CELL.toml "
                                  "states a drive along z; `draw` draws such a run.",
                                  "xyz"[static_cast<int>(drive->axis)]));
  Frame frame;
  const auto cycle = static_cast<std::size_t>(std::max(1, trajectory.info().phases_per_cycle));
  for (std::size_t f = 0; f < std::min(cycle, trajectory.n_frames()); ++f) {
    trajectory.read(f, frame);
    if (plate_rests(trajectory.info(), frame))
      throw ConfigError(Where{.file = trajectory.name(), .key = "cell.bottom_motion"},
                        "the plate rests while the drive moves other walls, but in a film the plate moves; "
                        "`draw` draws such a run.");
  }
}

std::string cell_text(const SyntheticCamera& camera, const TrajectoryInfo& info, const CameraOptions& options,
                      int first_phase) {
  const PixelFrame& map = camera.pixel_frame();
  std::string text = fmt::format(
      "[camera]\npixels_per_sigma = {:.17g}\nscale_error_px = 0\norigin_px = [{:.17g}, "
      "{:.17g}]\nframes_per_cycle = "
      "{}\nfirst_phase = {}\n",
      map.pixels_per_sigma, map.origin.x_px + info.box.lower.x() * map.pixels_per_sigma, map.origin.y_px,
      info.phases_per_cycle, first_phase);
  if (options.bright) text += "bright = true\n";
  if (!camera.lens().identity())
    text += fmt::format(
        "# The picture is rotated by {} degrees and has radial distortion {}; origin_px refers to the ideal "
        "picture.\n",
        options.rotation_deg, options.distortion);
  // If the file has a scale, a length without a unit is refused.
  const char* sigma = info.scale.sigma_m ? "_sigma" : "";
  text += fmt::format("\n[cell]\nwidth{0} = {1:.17g}\nheight{0} = {2:.17g}\nsides = \"{3}\"\n", sigma,
                      info.box.size().x(), info.box.size().z(), sides_word(info.box.boundary[0]));
  if (const auto [left, right] = camera.side_tilt(); left != 0 || right != 0)
    text += fmt::format("# The side walls lean outward by {} and {} degrees.\n", left, right);
  if (info.drive)
    text += fmt::format("\n[drive]\namplitude{} = {:.17g}\nomega{} = {:.17g}\n", sigma, info.drive->amplitude,
                        info.scale.sigma_m ? "_per_t0" : "", info.drive->omega);
  if (info.drive && !info.drive->harmonics.empty())
    text += "harmonics = " + harmonics_text(info.drive->harmonics) + "\n";
  if (info.drive && info.drive->recorded) text += "# The drive was recorded; this is its sine.\n";
  if (info.scale.sigma_m || info.scale.gravity_m_s2) text += "\n[scale]\n";
  if (info.scale.sigma_m) text += fmt::format("sigma_m = {:.17g}\n", *info.scale.sigma_m);
  if (info.scale.gravity_m_s2) text += fmt::format("gravity_m_s2 = {:.17g}\n", *info.scale.gravity_m_s2);
  return text;
}

// A frame of the trajectory while it is rendered and written.
struct Take {
  std::size_t index = 0;   // in the trajectory
  std::size_t number = 0;  // of its first copy among the stored frames
  int copies = 1;          // 0: dropped
  int phase = -1;          // drive phase of the frame
  Exposure exposure;
  cv::Mat picture;     // for the film
  std::string truth;   // rows of truth.csv
  std::string record;  // rows of frames.csv
};

class Filming {
 public:
  Filming(const TrajectorySource& trajectory, const CameraOptions& options)
      : trajectory_(trajectory),
        options_(options),
        camera_(options, trajectory.info()),
        moves_(options.exposure > 0 || options.trigger_jitter > 0 || options.trigger_offset != 0) {}
  [[nodiscard]] const SyntheticCamera& camera() const { return camera_; }

  // Fills one take: lamp and trigger, picture, records. Writes only to the take and its files, so that takes
  // can be filled in parallel.
  void shoot(Take& take, const std::filesystem::path& folder, bool keep) const {
    const Frame& frame = *take.exposure.now;
    const double n = static_cast<double>(trajectory_.n_frames());
    take.exposure.late =
        options_.trigger_offset +
        options_.trigger_jitter * RandomStream(options_.seed, Chance::trigger, frame.step).normal();
    take.exposure.lamp = std::max(
        0.0,
        (1 + options_.lamp_drift * (n > 1 ? static_cast<double>(take.index) / (n - 1) : 0)) *
            (1 + options_.lamp_flicker * RandomStream(options_.seed, Chance::lamp, frame.step).normal()));
    take.phase = frame.phase;
    if (take.copies == 0) return;
    const cv::Mat picture = camera_.expose(take.exposure);
    const std::vector<TrueBead> beads = camera_.truth(take.exposure);
    const TrajectoryInfo& info = trajectory_.info();
    const double period = info.drive ? info.drive->period() : 0;
    for (int copy = 0; copy < take.copies; ++copy) {
      const std::size_t number = take.number + static_cast<std::size_t>(copy);
      if (!folder.empty()) {
        const auto file = folder / fmt::format("frame_{:05}.png", number);
        // Noise does not compress: the lowest compression level gives files a tenth larger than the highest
        // and is five times faster.
        const auto bytes = codecs().encode(".png", picture, {cv::IMWRITE_PNG_COMPRESSION, 1});
        std::ofstream out(file, std::ios::binary);
        out.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
        out.close();
        if (bytes.empty() || !out) throw RunError(file.string() + ": cannot be written.");
      }
      for (const TrueBead& b : beads)
        fmt::format_to(std::back_inserter(take.truth), "{},{},{:.5f},{:.5f},{:.5f},{},{},{},{:.3f}\n", number,
                       b.slot, b.x, b.y, b.radius, int{b.tracer}, frame.phase, frame.cycle, b.visible);
      take.record +=
          fmt::format("{},{},{},{:.9g},{:.9g},{},{},{},{:.9g},{:.6f},{}\n", number, take.index, frame.step,
                      frame.time + take.exposure.late, take.exposure.late, frame.phase, frame.cycle,
                      phase_text(frame, take.exposure.late, period),
                      camera_.shutter().plate(take.exposure, take.exposure.late), take.exposure.lamp, copy);
    }
    if (keep) take.picture = picture;
  }

  // Reads the frames of the takes and the neighbours that their paths need, then fills the takes with
  // `threads` threads.
  void shoot(std::vector<Take>& takes, int threads, const std::filesystem::path& folder, bool keep) const {
    const std::size_t from = takes.front().index, to = takes.back().index + 1;
    const std::size_t first = moves_ && from > 0 ? from - 1 : from,
                      last = moves_ && to < trajectory_.n_frames() ? to + 1 : to;
    std::vector<Frame> frames(last - first);
    for (std::size_t f = first; f < last; ++f) trajectory_.read(f, frames[f - first]);
    for (Take& take : takes) {
      const std::size_t i = take.index - first;
      take.exposure.now = &frames[i];
      if (moves_ && i > 0) take.exposure.before = &frames[i - 1];
      if (moves_ && i + 1 < frames.size()) take.exposure.after = &frames[i + 1];
    }
    in_parallel(takes.size(), threads, [&](std::size_t i) { shoot(takes[i], folder, keep); });
  }

 private:
  // Fraction of the period at which the picture is actually taken; empty if unknown.
  [[nodiscard]] std::string phase_text(const Frame& frame, double late, double period) const {
    if (frame.phase < 0 || trajectory_.info().phases_per_cycle <= 0) return {};
    const double nominal = static_cast<double>(frame.phase) / trajectory_.info().phases_per_cycle;
    const double fraction = nominal + (period > 0 ? late / period : 0);
    return fmt::format("{:.9f}", fraction - std::floor(fraction));
  }

  const TrajectorySource& trajectory_;
  const CameraOptions& options_;
  SyntheticCamera camera_;
  bool moves_;
};

}  // namespace

Rendered render(const TrajectorySource& trajectory, const CameraOptions& options, const RenderJob& job,
                Progress& progress) {
  cv::setNumThreads(1);  // only the thread pool of this program
  const TrajectoryInfo& info = trajectory.info();
  options.check();
  CameraOptions fitted = options.reduced(info.scale);
  check_times(trajectory, fitted);
  check_drive(trajectory);
  if (fitted.max_height == 0) fitted.max_height = height_of_beads(trajectory, progress);
  const Filming filming(trajectory, fitted);

  // Outputs: written under temporary names and committed at the end, so that no incomplete output appears.
  std::optional<AtomicPath> place;
  std::optional<Movie> movie;
  std::filesystem::path folder;
  std::ofstream truth, record;
  if (!job.folder.empty()) {
    place.emplace(job.folder, rendered_stack());
    folder = place->part();
    truth.open(folder / "truth.csv");
    truth << "frame,id,x_px,y_px,r_px,tracer,phase,cycle,visible\n";
    record.open(folder / "frames.csv");
    record << "frame,source,step,time,late,phase,cycle,true_fraction,plate_height,lamp,copy\n";
  }
  if (!job.movie.empty()) movie.emplace(job.movie, filming.camera().size(), job.frames_per_second);

  // Batches: a few frames per thread bound the memory; drops and copies are drawn first, because they number
  // the files.
  Rendered done;
  int first_phase = -1;
  const std::size_t n = trajectory.n_frames(), batch = 4 * static_cast<std::size_t>(std::max(job.threads, 1));
  for (std::size_t from = 0; from < n; from += batch) {
    std::vector<Take> takes;
    for (std::size_t f = from; f < std::min(n, from + batch); ++f) {
      RandomStream chance(fitted.seed, Chance::storage, static_cast<std::int64_t>(f));
      const bool lost = chance.uniform() < fitted.drop, twice = chance.uniform() < fitted.doubled;
      takes.push_back({.index = f, .number = done.frames, .copies = lost ? 0 : twice ? 2 : 1});
      done.frames += static_cast<std::size_t>(takes.back().copies);
      done.dropped += lost ? 1 : 0;
      done.doubled += takes.back().copies == 2 ? 1 : 0;
    }
    filming.shoot(takes, job.threads, folder, movie.has_value());
    for (const Take& take : takes) {
      if (take.copies > 0 && first_phase < 0) first_phase = std::max(0, take.phase);
      truth << take.truth;
      record << take.record;
      for (int copy = 0; movie && copy < take.copies; ++copy) movie->add(take.picture, fitted.bits);
    }
    progress.update(static_cast<std::int64_t>(std::min(n, from + batch)), static_cast<std::int64_t>(n));
  }
  if (n == 0) throw InputError({.file = trajectory.name()}, "the trajectory contains no frame.");
  if (done.frames == 0) throw RunError("every frame was dropped: nothing is left to write.");
  // Descriptions: CELL.toml and CAMERA.toml, with which the stack can be tracked like an experiment.
  if (place) {
    truth.close();
    record.close();
    if (!truth || !record) throw RunError(job.folder.string() + ": cannot be written.");
    write_text_file(folder / "CELL.toml",
                    cell_text(filming.camera(), info, fitted, std::max(0, first_phase)));
    write_text_file(folder / "CAMERA.toml", camera_text(fitted));
  }
  if (movie) movie->commit();
  if (place) place->commit();
  return done;
}

std::size_t render(const TrajectorySource& trajectory, const CameraOptions& options,
                   const std::filesystem::path& folder, Progress& progress) {
  return render(trajectory, options, RenderJob{.folder = folder}, progress).frames;
}

}  // namespace twincell::imaging
