#include "calibration/film/track_film.hpp"

#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <optional>
#include <utility>

#include "core/error.hpp"
#include "core/json_text.hpp"
#include "imaging/preprocess/open_flattened.hpp"
#include "imaging/preprocess/region.hpp"
#include "imaging/settings/check_scale.hpp"
#include "imaging/stack/open_frames.hpp"

namespace twincell::calibration {

namespace {

/// Whether the drive is one that the cell states and the frames can contradict.
bool checks_drive(const FilmedCell& filmed, const FilmOptions& options) {
  return filmed.measured_drive.empty() && !options.trust_stated_drive && filmed.cell.drive();
}

/// Refuses an incomplete or contradictory drive before the work starts.
/// \throws ConfigError naming the cell file, if it is what states the drive
void check_stated_drive(const imaging::CellDescription& cell, const imaging::TrackRequest& request) {
  try {
    (void)cell.drive();
  } catch (const ConfigError& e) {
    if (request.cell_file.empty() || request.gamma || request.amplitude) throw;
    throw ConfigError({.file = request.cell_file}, e.what());
  }
}

imaging::LocatorOptions locator_of(const imaging::CellDescription& cell, const FilmOptions& options) {
  return imaging::locator_of(
      options.locating, cell.disc_px(),
      options.request.cell_file.empty() ? std::nullopt : std::optional<bool>(cell.bright), cell.refine);
}

/// Plans the trajectory, checks the stated drive by the motion of the bed unless the plate has decided, and
/// stores the report of both.
TrackedFilm planned(FilmedCell filmed, imaging::TrackedStack stack, DriveCheck check,
                    const FilmOptions& options, StageTimes* times) {
  imaging::TrackPlan plan = [&] {
    const Stage planning(times, "plan");
    return imaging::plan_trajectory(stack, filmed.cell, stack.locator.diameter_px, options.shortest);
  }();
  // With neither scale nor origin, nothing relates the heights of the bed to those of the plate.
  const bool placed = filmed.cell.pixels_per_sigma || filmed.cell.origin;
  if (checks_drive(filmed, options) && check.disagreement.empty() && placed) {
    const Stage checking(times, "drive check");
    BedSteps bed(plan.info);
    imaging::write_trajectory(stack, plan, bed);
    if (check.by.empty())
      check = check_by_bed(bed, plan.info, check);
    else
      check.disagreement = contradiction_of_bed(bed, plan.info);
  }
  if (!check.doubt.empty()) stack.settings_doubts.push_back(check.doubt);
  const bool states_drive = plan.info.drive && filmed.measured_drive.empty();
  TrackedFilm film{.cell = std::move(filmed.cell),
                   .stack = std::move(stack),
                   .plan = std::move(plan),
                   .check = std::move(check),
                   .states_drive = states_drive};
  film.plan.info.tracking_json = json_text(film.report());
  return film;
}

}  // namespace

nlohmann::json TrackedFilm::report() const {
  nlohmann::json document = imaging::tracking_report(stack, plan, cell);
  if (states_drive) document.update(report_of(check));
  return document;
}

FilmedCell check_beads(FilmedCell filmed, const OpenFrames& open, const std::filesystem::path& film,
                       const FilmOptions& options, const ProgressOf& progress) {
  const imaging::LocatorOptions locator = locator_of(filmed.cell, options);
  if (!locator.diameter_of_scale) return filmed;
  const auto searching = progress("settings");
  const auto frames = film.empty() ? open(locator)
                                   : imaging::prepare_frames(imaging::open_frames(film), film.string(),
                                                             options.locating, locator);
  const imaging::Region region = imaging::region_of(options.locating);
  imaging::RegionFrames seen(*frames, region);
  imaging::FramesAhead ahead(seen);
  const imaging::StatedDiscs stated{
      .file = options.request.cell_file,
      .key = filmed.cell.disc_width_px ? "camera.disc_width_px" : "camera.pixels_per_sigma",
      .polarity_open = !options.locating.dark && !locator.preprocess.bright,
      .refiner_open = !options.locating.refine_given && !filmed.cell.refine};
  if (const auto refiner = check_beads_at_scale(ahead, locator, stated, options.threads)) {
    filmed.cell.refine = refiner;
    filmed.found_refiner = fmt::format(
        "the method \"{}\" finds few beads of the stated scale, so that \"{}\" locates them: state "
        "camera.refine = \"{}\"",
        locator.refine.method, *refiner, *refiner);
  }
  return filmed;
}

FilmedCell stated_cell(const FilmOptions& options, const imaging::FrameRange& range) {
  FilmedCell stated{.cell = imaging::resolve_cell(options.request),
                    .source = {},
                    .measured_drive = {},
                    .found_refiner = {}};
  const imaging::StatedPhases phases =
      imaging::stated_phases(options.request.phase, stated.cell, options.request.cell_file);
  stated.source = phases.source;
  stated.source.trusted = options.trust_stated_drive;
  stated.cell.phase_lock = imaging::lock_of_chosen(phases.lock, range);
  return stated;
}

DriveCheck check_plate(const FilmedCell& filmed, const std::filesystem::path& film,
                       const FilmOptions& options, const ProgressOf& progress, StageTimes* times) {
  if (!checks_drive(filmed, options)) return {.not_comparable = "the stated drive is trusted"};
  if (film.empty()) return {};
  const Stage checking(times, "drive check");
  const auto edge = progress("the plate's edge");
  return check_by_plate(filmed.cell, film, imaging::frames_of(options.locating), options.threads, *edge,
                        filmed.source.method == imaging::PhaseMethod::fixed);
}

TrackedFilm track_filmed_cell(const OpenFrames& open, FilmedCell filmed, DriveCheck by_plate,
                              const FilmOptions& options, const ProgressOf& progress, StageTimes* times) {
  const imaging::CellDescription& cell = filmed.cell;
  const imaging::LocatorOptions locator = locator_of(cell, options);
  const imaging::Region region = imaging::region_of(options.locating);
  const auto frames = open(locator);
  imaging::TrackedStack stack = [&] {
    const auto bar = progress("track");
    return imaging::track_stack(*frames, cell,
                                {.locator = locator,
                                 .link = options.link,
                                 .phases = filmed.source,
                                 .region = region,
                                 .threads = options.threads,
                                 .folder = options.folder},
                                *bar, times);
  }();
  if (!filmed.found_refiner.empty()) stack.settings_doubts.push_back(filmed.found_refiner);
  imaging::check_flat(options.locating.flat, stack.locator.preprocess.bright);
  return planned(std::move(filmed), std::move(stack), std::move(by_plate), options, times);
}

TrackedFilm track_film(const OpenFrames& open, const std::filesystem::path& film, const FilmOptions& options,
                       const ProgressOf& progress, StageTimes* times) {
  FilmedCell filmed = stated_cell(options, imaging::frames_of(options.locating));
  check_stated_drive(filmed.cell, options.request);
  filmed = check_beads(std::move(filmed), open, film, options, progress);
  DriveCheck by_plate = check_plate(filmed, film, options, progress, times);
  return track_filmed_cell(open, std::move(filmed), std::move(by_plate), options, progress, times);
}

TrackedFilm track_table(const Table& table, imaging::LocatedTableOptions located, const FilmOptions& options,
                        const ProgressOf& progress, StageTimes* times) {
  if (const std::string option = imaging::option_for_frames(options.locating); !option.empty())
    throw ConfigError({.file = table.file, .key = option},
                      "says how the beads of frames are located; those of a table are.");
  if (!options.locating.diameters.empty()) located.diameter_px = options.locating.diameters.front();
  imaging::LocatedTable beads = imaging::read_located(table, located, options.folder);
  FilmedCell filmed = stated_cell(options, beads.range);
  check_stated_drive(filmed.cell, options.request);
  imaging::TrackedStack stack = [&] {
    const auto bar = progress("track");
    const Stage linking(times, "linking", "links");
    return imaging::track_located(std::move(beads), options.link, filmed.cell, filmed.source, options.folder,
                                  *bar);
  }();
  DriveCheck check = check_plate(filmed, {}, options, progress, times);
  return planned(std::move(filmed), std::move(stack), std::move(check), options, times);
}

}  // namespace twincell::calibration
