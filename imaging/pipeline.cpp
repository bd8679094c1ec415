#include "imaging/pipeline.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <exception>
#include <limits>
#include <thread>

#include "analysis/trajectory/error.hpp"

namespace twincell {

namespace {

// Each frame is a unit of work of its own, so that results do not depend on who computes them.
std::vector<Located> locate_batch(const std::vector<cv::Mat>& batch, const LocatorOptions& options,
                                  int threads) {
  std::vector<Located> results(batch.size());
  std::vector<std::exception_ptr> failures(batch.size());
  std::atomic<std::size_t> next{0};
  auto work = [&] {
    for (std::size_t i = next++; i < batch.size(); i = next++) try {
        results[i] = locate(batch[i], options);
      } catch (...) {
        failures[i] = std::current_exception();
      }
  };
  {
    std::vector<std::jthread> others;
    const auto n = std::min(static_cast<std::size_t>(std::max(threads, 1)), batch.size());
    for (std::size_t t = 1; t < n; ++t) others.emplace_back(work);
    work();
  }
  for (const std::exception_ptr& failure : failures)
    if (failure) std::rethrow_exception(failure);
  return results;
}

bool outside(const CellDescription& cell, const Detection& b) {
  if (!cell.origin || !cell.pixels_per_sigma) return false;
  const Vec3 r = PixelFrame{*cell.pixels_per_sigma, *cell.origin}.cell_from_pixel({b.x, b.y});
  return (cell.width && (r.x() < 0 || r.x() > *cell.width)) || (cell.height && r.z() > *cell.height + 0.5);
}

}  // namespace

std::int64_t locate_stack(FrameSource& frames, LocatorOptions& options, int threads, const LocatedSink& sink,
                          Progress& progress) {
  cv::setNumThreads(1);  // one pool only: ours
  const std::size_t batch_size = 2 * static_cast<std::size_t>(std::max(threads, 1));
  std::int64_t done = 0;
  for (bool more = true; more;) {
    std::vector<cv::Mat> batch;
    for (cv::Mat frame; batch.size() < batch_size && (more = frames.next(frame)); frame = cv::Mat())
      batch.push_back(frame);
    if (batch.empty()) break;
    if (options.diameter_px <= 0) {
      options.diameter_px = estimate_diameter(batch.front(), options.preprocess);
      if (options.diameter_px <= 0)
        throw InputError(
            Where{.file = frames.current(), .key = {}},
            "shows no discs from which a bead diameter could be estimated; give it with --diameter.");
    }
    const std::vector<Located> results = locate_batch(batch, options, threads);
    for (std::size_t i = 0; i < batch.size(); ++i) sink(done++, batch[i], results[i]);
    progress.update(done, static_cast<std::int64_t>(frames.announced()));
  }
  if (done == 0) throw InputError(Where{.file = frames.current(), .key = {}}, "holds no frame.");
  return done;
}

TrackedStack track_stack(FrameSource& frames, LocatorOptions& locator, LinkOptions link,
                         const CellDescription& cell, int threads, Progress& progress) {
  TrackedStack stack;
  std::optional<Linker> linker;
  locate_stack(
      frames, locator, threads,
      [&](std::int64_t, const cv::Mat& grey, const Located& located) {
        if (!linker) {
          link.diameter_px = locator.diameter_px;
          linker.emplace(link);
        }
        stack.width_px = grey.cols;
        stack.height_px = grey.rows;
        std::vector<PixelPoint> places;
        std::vector<TrackedBead> beads;
        for (const Detection& b : located.beads) {
          if (outside(cell, b)) {
            ++stack.outside_cell;
            continue;
          }
          places.push_back({b.x, b.y});
          beads.push_back({b.x, b.y, b.radius, -1, b.tracer});
        }
        const std::vector<std::int64_t> ids = linker->next(places);
        for (std::size_t k = 0; k < beads.size(); ++k) beads[k].track = ids[k];
        stack.frames.push_back(std::move(beads));
      },
      progress);
  stack.n_tracks = linker->n_tracks();
  return stack;
}

TrackPlan plan_trajectory(const TrackedStack& stack, const CellDescription& cell, double diameter_px,
                          int shortest) {
  TrackPlan plan;
  const double scale = cell.pixels_per_sigma.value_or(diameter_px);
  plan.pixel_frame = {scale, cell.origin.value_or(PixelPoint{-0.5, stack.height_px - 0.5})};

  const auto n = static_cast<std::size_t>(stack.n_tracks);
  std::vector<int> seen(n), tracer(n);
  std::vector<double> radius(n);
  for (const auto& frame : stack.frames)
    for (const TrackedBead& b : frame) {
      const auto t = static_cast<std::size_t>(b.track);
      ++seen[t];
      tracer[t] += b.tracer ? 1 : 0;
      radius[t] += b.radius_px;
    }
  TrajectoryInfo& info = plan.info;
  plan.slot_of_track.assign(n, -1);
  for (std::size_t t = 0; t < n; ++t) {
    if (seen[t] < shortest) continue;
    plan.slot_of_track[t] = static_cast<std::int64_t>(info.n_beads++);
    info.radius.push_back(radius[t] / seen[t] / scale);
    info.tracer.push_back(2 * tracer[t] > seen[t] ? 1 : 0);
  }
  info.drive = cell.drive();
  info.columns.identity = true;
  info.columns.phase = cell.phase_lock.locked();
  info.columns.plate_height = info.drive && cell.phase_lock.locked();
  info.phases_per_cycle = cell.phase_lock.frames_per_cycle;
  info.box.lower = Vec3(0, -0.5, 0);
  info.box.upper =
      Vec3(cell.width.value_or(stack.width_px / scale), 0.5, cell.height.value_or(stack.height_px / scale));
  info.box.boundary = {cell.width ? cell.sides : Boundary::open, Boundary::open,
                       cell.origin ? Boundary::wall : Boundary::open};
  info.scale = cell.scale;
  info.scale.pixels_per_sigma = scale;
  info.source = "experiment";
  return plan;
}

void write_trajectory(const TrackedStack& stack, const TrackPlan& plan, const CellDescription& cell,
                      TrajectorySink& sink) {
  const TrajectoryInfo& info = plan.info;
  const PhaseLock& lock = cell.phase_lock;
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (std::size_t f = 0; f < stack.frames.size(); ++f) {
    const auto number = static_cast<std::int64_t>(f);
    Frame frame;
    frame.step = number;
    frame.phase = lock.phase(number);
    frame.cycle = lock.cycle(number);
    frame.time = static_cast<double>(f);
    if (info.drive && lock.locked()) {
      frame.time = (static_cast<double>(frame.cycle) + lock.fraction(number)) * info.drive->period();
      frame.plate_height = info.drive->displacement(lock.fraction(number));
    }
    frame.position.assign(info.n_beads, Vec3(nan, nan, nan));
    frame.id.assign(info.n_beads, -1);
    for (const TrackedBead& b : stack.frames[f]) {
      const std::int64_t slot = plan.slot_of_track[static_cast<std::size_t>(b.track)];
      if (slot < 0) continue;
      frame.id[static_cast<std::size_t>(slot)] = slot;
      frame.position[static_cast<std::size_t>(slot)] = plan.pixel_frame.cell_from_pixel({b.x_px, b.y_px});
    }
    sink.append(frame);
  }
}

}  // namespace twincell
