#include "calibration/drive/track_film.hpp"

#include "core/error.hpp"
#include "imaging/preprocess/open_flattened.hpp"

namespace twincell::calibration {

namespace {

/// The cell and the source of the phases that the options state.
struct StatedCell {
  imaging::CellDescription cell;
  imaging::PhaseSource source;
};

StatedCell stated_cell(const FilmOptions& options, const imaging::FrameRange& range) {
  StatedCell stated{imaging::resolve_cell(options.request), {}};
  stated.source = imaging::phase_source(options.request.phase, stated.cell, options.request.cell_file);
  stated.source.trusted = options.trust_stated_drive;
  (void)stated.cell.drive();  // refuse a contradictory drive before the work starts
  stated.cell.phase_lock = imaging::lock_of_chosen(stated.cell.phase_lock, range);
  return stated;
}

/// Checks the stated drive by the motion of the bed, unless the plate has decided. \param check by the plate
DriveCheck checked_by_bed(const imaging::CellDescription& cell, const imaging::TrackedStack& stack,
                          const imaging::TrackPlan& plan, DriveCheck check) {
  if (!check.by.empty() || !check.disagreement.empty() || !cell.pixels_per_sigma) return check;
  BedSteps bed(plan.info);
  imaging::write_trajectory(stack, plan, bed);
  return check_by_bed(bed, plan.info, check);
}

imaging::TrackPlan planned(const imaging::TrackedStack& stack, const imaging::CellDescription& cell,
                           int shortest, StageTimes* times) {
  const Stage planning(times, "plan");
  return imaging::plan_trajectory(stack, cell, stack.locator.diameter_px, shortest);
}

}  // namespace

TrackedFilm track_film(
    const std::function<std::unique_ptr<imaging::FrameSource>(const imaging::LocatorOptions&)>& open,
    const std::filesystem::path& film, const FilmOptions& options,
    const std::function<std::unique_ptr<Progress>(const std::string& stage)>& progress, StageTimes* times) {
  const imaging::FrameRange range = imaging::frames_of(options.locating);
  StatedCell stated = stated_cell(options, range);
  imaging::CellDescription& cell = stated.cell;
  const imaging::PhaseSource& source = stated.source;
  const imaging::LocatorOptions locator = imaging::locator_of(
      options.locating, cell.pixels_per_sigma,
      options.request.cell_file.empty() ? std::nullopt : std::optional<bool>(cell.bright), cell.refine);
  const imaging::Region region = imaging::region_of(options.locating);
  // Locate and link all frames.
  const auto frames = open(locator);
  imaging::TrackedStack stack = [&] {
    const auto bar = progress("track");
    return imaging::track_stack(*frames, locator, options.link, cell, options.threads, *bar, source,
                                options.folder, region, times);
  }();
  imaging::check_flat(options.locating.flat, stack.locator.preprocess.bright);
  imaging::TrackPlan plan = planned(stack, cell, options.shortest, times);
  // Check the stated drive against the motion of the plate, or of the bed if the plate is not visible.
  DriveCheck check{.not_comparable = "the stated drive is trusted"};
  if (!options.trust_stated_drive && plan.info.drive) {
    const Stage checking(times, "drive check");
    if (!film.empty()) {
      const auto edge = progress("the plate's edge");
      check = check_by_plate(cell, film, range, options.threads, *edge,
                             source.method == imaging::PhaseMethod::fixed);
    }
    check = checked_by_bed(cell, stack, plan, std::move(check));
  }
  if (plan.info.drive) record(check, plan.info);
  return {std::move(cell), std::move(stack), std::move(plan), std::move(check)};
}

TrackedFilm track_table(const Table& table, imaging::LocatedTableOptions located, const FilmOptions& options,
                        const std::function<std::unique_ptr<Progress>(const std::string& stage)>& progress,
                        StageTimes* times) {
  if (const std::string option = imaging::option_for_frames(options.locating); !option.empty())
    throw ConfigError({.file = table.file, .key = option},
                      "says how the beads of frames are located; those of a table are.");
  if (!options.locating.diameters.empty()) located.diameter_px = options.locating.diameters.front();
  imaging::LocatedTable beads = imaging::read_located(table, located, options.folder);
  StatedCell stated = stated_cell(options, beads.range);
  imaging::CellDescription& cell = stated.cell;
  imaging::TrackedStack stack = [&] {
    const auto bar = progress("track");
    const Stage linking(times, "linking", "links");
    return imaging::track_located(std::move(beads), options.link, cell, stated.source, options.folder, *bar);
  }();
  imaging::TrackPlan plan = planned(stack, cell, options.shortest, times);
  DriveCheck check{.not_comparable = "the stated drive is trusted"};
  if (!options.trust_stated_drive && plan.info.drive) {
    const Stage checking(times, "drive check");
    check = checked_by_bed(cell, stack, plan, {});
  }
  if (plan.info.drive) record(check, plan.info);
  return {std::move(cell), std::move(stack), std::move(plan), std::move(check)};
}

}  // namespace twincell::calibration
