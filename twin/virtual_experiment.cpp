#include "twin/virtual_experiment.hpp"

#include <map>

#include "core/atomic_file.hpp"
#include "imaging/camera/synthetic_camera.hpp"
#include "imaging/cell/cell.hpp"
#include "imaging/stack/open_frames.hpp"
#include "imaging/stack/representative_frames.hpp"
#include "imaging/track/track.hpp"
#include "imaging/track/write_trajectory.hpp"
#include "trajectory/formats/h5md_file.hpp"

namespace twincell::twin {
namespace {

/// Adds the pictures of the snapshots that were filmed, and the camera.
void add_pictures(const TrajectorySource& filmed, const std::filesystem::path& frames,
                  const imaging::CellDescription& cell, const imaging::TrackedStack& stack,
                  analysis::Show& show) {
  std::map<std::int64_t, std::int64_t> number_of_step;
  Frame frame;
  for (std::size_t f = 0; f < filmed.n_frames(); ++f) {
    filmed.read(f, frame);
    number_of_step[frame.step] = static_cast<std::int64_t>(f);
  }
  std::vector<std::int64_t> numbers;
  std::vector<std::size_t> moments;
  for (std::size_t m = 0; m < show.snapshots.size(); ++m)
    if (const auto found = number_of_step.find(show.snapshots[m].frame.step); found != number_of_step.end()) {
      numbers.push_back(found->second);
      moments.push_back(m);
    }
  const auto source = imaging::open_frames(frames);
  const auto pictures = imaging::picture_frames(*source, numbers);
  show.pictures.assign(show.snapshots.size(), {});
  for (std::size_t i = 0; i < moments.size(); ++i) show.pictures[moments[i]] = pictures[i];
  const double s = *cell.pixels_per_sigma;
  show.camera = {
      .pixels_per_sigma = s,
      .origin_x = cell.origin->x_px - filmed.info().box.lower.x() * s,  // the film's cell starts at x = 0
      .origin_y = cell.origin->y_px,
      .width = stack.width_px,
      .height = stack.height_px};
}

}  // namespace

void film_and_track(const TrajectorySource& simulation, const imaging::CameraOptions& camera,
                    const std::filesystem::path& tracked, int threads, analysis::Show& show,
                    Progress& progress) {
  std::filesystem::path place = tracked;
  place += ".frames";
  const AtomicPath film(place, Product::whole_folder("a film"));  // not committed, so removed at the end
  const std::filesystem::path frames = film.part() / "frames";
  imaging::CameraOptions whole = camera;
  whole.drop = whole.doubled = 0;  // the phases of the film follow from the frame numbers
  imaging::render(simulation, whole, imaging::RenderJob{.folder = frames, .threads = threads}, progress);

  const imaging::CellDescription cell = imaging::read_cell(frames / "CELL.toml");
  imaging::LocatorOptions locator;
  locator.diameter_px = *cell.pixels_per_sigma;
  locator.preprocess.bright = cell.bright;
  const auto source = imaging::open_frames(frames);
  const imaging::TrackedStack stack = imaging::track_stack(
      *source, cell,
      {.locator = locator, .phases = {.trusted = true}, .threads = threads, .folder = film.part()}, progress);
  imaging::TrackPlan plan = imaging::plan_trajectory(stack, cell, stack.locator.diameter_px, 1);
  // If the simulation marks no tracers, the film has no darker beads; the analysis then chooses the tracers
  // of both by the same rule.
  if (simulation.info().tracer.empty()) plan.info.tracer.clear();
  H5mdWriter writer(tracked, plan.info);
  imaging::write_trajectory(stack, plan, writer);
  writer.finish();
  add_pictures(simulation, frames, cell, stack, show);
}

}  // namespace twincell::twin
