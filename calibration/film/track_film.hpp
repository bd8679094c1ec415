#pragma once
/// \file
/// Tracks a film from the frames to the plan of its trajectory: cell, beads, phases, links, and the check of
/// the stated drive. `track` and `match` perform the same steps; `match` checks the cell between them.

#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <string>
#include <vector>

#include "calibration/drive/plate_drive.hpp"
#include "core/progress.hpp"
#include "core/stage_times.hpp"
#include "imaging/track/located_table.hpp"
#include "imaging/track/locating_request.hpp"
#include "imaging/track/track.hpp"
#include "imaging/track/track_request.hpp"
#include "imaging/track/write_trajectory.hpp"

namespace twincell::calibration {

/// Options of a film.
struct FilmOptions {
  imaging::TrackRequest request;
  imaging::LocatingRequest locating;  ///< beads, and the part of the film that is searched
  imaging::LinkOptions link;
  int shortest = 1;                 ///< frames of the shortest track that is written
  bool trust_stated_drive = false;  ///< do not check the stated drive and phase lock against the frames
  int threads = 1;
  std::filesystem::path folder = {};  ///< for temporary files, as in track_stack
};

/// The cell of a film and the source of its phases.
struct FilmedCell {
  imaging::CellDescription cell;
  imaging::PhaseSource source;
  /// The drive as measured on the plate, a sentence; empty if the cell states it.
  std::string measured_drive;
  /// The refiner as the frames show it, a sentence without a full stop; empty if the cell's discs are found.
  std::string found_refiner;
};

/// A tracked film. Its trajectory is written by write_trajectory(stack, plan, sink).
struct TrackedFilm {
  imaging::CellDescription cell;
  imaging::TrackedStack stack;
  imaging::TrackPlan plan;
  DriveCheck check;
  bool states_drive = false;  ///< the cell states the drive, so that the check belongs to the report
  /// The report that `track` prints and stores: that of the tracking (tracking_report), and of the check.
  [[nodiscard]] nlohmann::json report() const;
};

/// Opens the frames (prepare_frames); its argument is the options with which the beads are located.
using OpenFrames = std::function<std::unique_ptr<imaging::FrameSource>(const imaging::LocatorOptions&)>;

/// Step 1: the cell and the phases that the options state, for the chosen frames. The drive may be
/// incomplete.
/// \throws ConfigError, InputError as resolve_cell, stated_phases, lock_of_chosen
FilmedCell stated_cell(const FilmOptions& options, const imaging::FrameRange& range);

/// Step 2: where the cell states the scale of the beads, checks it, and their polarity, by the first frames.
/// If the default refiner does not find the beads there and another one does, the cell has that one then.
/// \param film file or folder of the frames; empty for frames in memory
/// \throws ConfigError as check_beads_at_scale; InputError as `open`
FilmedCell check_beads(FilmedCell filmed, const OpenFrames& open, const std::filesystem::path& film,
                       const FilmOptions& options, const ProgressOf& progress);

/// Step 3: checks the stated drive against the motion of the plate. Nothing is compared if there is no drive,
/// if it was measured, or if it is trusted.
/// \param film file or folder of the frames; empty for frames in memory, in which nothing is compared
DriveCheck check_plate(const FilmedCell& filmed, const std::filesystem::path& film,
                       const FilmOptions& options, const ProgressOf& progress, StageTimes* times = nullptr);

/// Step 4: locates and links the beads. If the plate did not decide, checks the stated drive by the motion of
/// the bed. Records the check in the plan.
/// \param progress makes the progress of the stage "track"
/// \param times receives the times of the stages of track_stack, and of "plan" and "drive check"; null: not
/// timed
/// \throws ConfigError, InputError as track_stack
TrackedFilm track_filmed_cell(const OpenFrames& open, FilmedCell filmed, DriveCheck by_plate,
                              const FilmOptions& options, const ProgressOf& progress,
                              StageTimes* times = nullptr);

/// All four steps.
/// \throws as they do
TrackedFilm track_film(const OpenFrames& open, const std::filesystem::path& film, const FilmOptions& options,
                       const ProgressOf& progress, StageTimes* times = nullptr);

/// Links the beads of a table and checks the stated drive against the motion of the bed.
/// \param located names of columns, picture; `options.locating` may contain one diameter and nothing else
/// \throws ConfigError, InputError as resolve_cell, stated_phases, read_located, track_located; ConfigError
/// for an option that says how the beads of frames are located
TrackedFilm track_table(const Table& table, imaging::LocatedTableOptions located, const FilmOptions& options,
                        const ProgressOf& progress, StageTimes* times = nullptr);

}  // namespace twincell::calibration
