#include "calibration/drive/track_film.hpp"

#include "imaging/preprocess/open_flattened.hpp"

namespace twincell::calibration {

TrackedFilm track_film(
    const std::function<std::unique_ptr<imaging::FrameSource>(const imaging::LocatorOptions&)>& open,
    const std::filesystem::path& film, const FilmOptions& options,
    const std::function<std::unique_ptr<Progress>(const std::string& stage)>& progress, StageTimes* times) {
  const imaging::TrackRequest& request = options.request;
  imaging::CellDescription cell = imaging::resolve_cell(request);
  imaging::PhaseSource source = imaging::phase_source(request.phase, cell, request.cell_file);
  source.trusted = options.trust_stated_drive;
  (void)cell.drive();  // refuse a contradictory drive before the work starts
  const imaging::FrameRange range = imaging::frames_of(options.locating);
  cell.phase_lock = imaging::lock_of_chosen(cell.phase_lock, range);
  const imaging::LocatorOptions locator = imaging::locator_of(
      options.locating, cell.pixels_per_sigma,
      request.cell_file.empty() ? std::nullopt : std::optional<bool>(cell.bright), cell.refine);
  const imaging::Region region = imaging::region_of(options.locating);
  // Locate and link all frames.
  const auto frames = open(locator);
  imaging::TrackedStack stack = [&] {
    const auto bar = progress("track");
    return imaging::track_stack(*frames, locator, options.link, cell, options.threads, *bar, source,
                                options.folder, region, times);
  }();
  imaging::check_flat(options.locating.flat, stack.locator.preprocess.bright);
  imaging::TrackPlan plan = [&] {
    const Stage planning(times, "plan");
    return imaging::plan_trajectory(stack, cell, stack.locator.diameter_px, options.shortest);
  }();
  // Check the stated drive against the motion of the plate, or of the bed if the plate is not visible.
  DriveCheck check{.not_comparable = "the stated drive is trusted"};
  if (!options.trust_stated_drive && plan.info.drive) {
    const Stage checking(times, "drive check");
    if (!film.empty()) {
      const auto edge = progress("the plate's edge");
      check = check_by_plate(cell, film, range, options.threads, *edge,
                             source.method == imaging::PhaseMethod::fixed);
    }
    if (check.by.empty() && check.disagreement.empty() && cell.pixels_per_sigma) {
      BedSteps bed(plan.info);
      imaging::write_trajectory(stack, plan, bed);
      check = check_by_bed(bed, plan.info, check);
    }
  }
  if (plan.info.drive) record(check, plan.info);
  return {std::move(cell), std::move(stack), std::move(plan), std::move(check)};
}

}  // namespace twincell::calibration
