#include "calibration/drive/track_film.hpp"

#include "imaging/preprocess/open_flattened.hpp"

namespace twincell {

TrackedFilm track_film(const std::function<std::unique_ptr<FrameSource>()>& open,
                       const std::filesystem::path& film, const FilmOptions& options,
                       const std::function<std::unique_ptr<Progress>(const std::string& stage)>& progress) {
  CellDescription cell = resolve_cell(options.request);
  const PhaseSource source = phase_source(options.request, cell);
  (void)cell.drive();  // refuse a contradictory drive before the work starts
  LocatorOptions locator = options.locator;
  locator.preprocess.bright |= cell.bright;
  if (options.diameters.empty()) {
    locator.diameter_px = cell.pixels_per_sigma.value_or(0);
  } else {
    locator.diameter_px = options.diameters.front();
    locator.other_diameters_px.assign(options.diameters.begin() + 1, options.diameters.end());
  }
  // Locate and link all frames.
  const auto frames = open();
  TrackedStack stack = [&] {
    const auto bar = progress("track");
    return track_stack(*frames, locator, options.link, cell, options.threads, *bar, source, options.folder);
  }();
  check_flat(options.flat, stack.locator.preprocess.bright);
  TrackPlan plan = plan_trajectory(stack, cell, stack.locator.diameter_px, options.shortest);
  // Check the stated drive against the motion of the plate, or of the bed if the plate is not visible.
  DriveCheck check{.not_comparable = "the stated drive is trusted"};
  if (!options.trust_stated_drive && plan.info.drive) {
    if (!film.empty()) {
      const auto edge = progress("the plate's edge");
      check = check_by_plate(cell, film, options.threads, *edge, source.method == PhaseMethod::fixed);
    }
    if (check.by.empty() && cell.pixels_per_sigma) {
      BedSteps bed(plan.info);
      write_trajectory(stack, plan, cell, bed);
      check = check_by_bed(bed, plan.info, check.frame_rate_hz);
    }
  }
  if (plan.info.drive) record(check, plan.info);
  return {std::move(cell), std::move(stack), std::move(plan), std::move(check)};
}

}  // namespace twincell
