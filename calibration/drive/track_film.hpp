#pragma once
/// \file
/// Tracks a film from the frames to the plan of its trajectory: cell, beads, phases, links, and the check of
/// the stated drive.

#include <functional>
#include <memory>
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

/// Options of track_film and track_table.
struct FilmOptions {
  imaging::TrackRequest request;
  imaging::LocatingRequest locating;  ///< beads, and the part of the film that is searched
  imaging::LinkOptions link;
  int shortest = 1;                 ///< frames of the shortest track that is written
  bool trust_stated_drive = false;  ///< do not check the stated drive and phase lock against the frames
  int threads = 1;
  std::filesystem::path folder = {};  ///< for temporary files, as in track_stack
};

/// A tracked film. Its trajectory is written by write_trajectory(stack, plan, sink).
struct TrackedFilm {
  imaging::CellDescription cell;
  imaging::TrackedStack stack;
  imaging::TrackPlan plan;
  DriveCheck check;
};

/// Locates, links, and checks the stated drive against the motion of the plate, or of the bed if the plate is
/// not visible. The result of the check is recorded in the plan.
/// \param open opens the frames (prepare_frames), after the cell is known to be valid; its argument is the
/// options with which the beads are located
/// \param film file or folder of the frames, which is read again for the plate; empty for frames in memory,
/// whose drive is checked against the bed only
/// \param progress makes the progress of the stages "track" and "the plate's edge"
/// \param times receives the times of the stages of track_stack, and of "drive check" and "plan"; null: not
/// timed
/// \throws ConfigError, InputError as resolve_cell, phase_source, track_stack
TrackedFilm track_film(
    const std::function<std::unique_ptr<imaging::FrameSource>(const imaging::LocatorOptions&)>& open,
    const std::filesystem::path& film, const FilmOptions& options,
    const std::function<std::unique_ptr<Progress>(const std::string& stage)>& progress,
    StageTimes* times = nullptr);

/// Links the beads of a table and checks the stated drive against the motion of the bed.
/// \param located names of columns, picture; `options.locating` may contain one diameter and nothing else
/// \throws ConfigError, InputError as resolve_cell, phase_source, read_located, track_located; ConfigError
/// for an option that says how the beads of frames are located
TrackedFilm track_table(const Table& table, imaging::LocatedTableOptions located, const FilmOptions& options,
                        const std::function<std::unique_ptr<Progress>(const std::string& stage)>& progress,
                        StageTimes* times = nullptr);

}  // namespace twincell::calibration
