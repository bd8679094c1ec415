#pragma once
/// \file
/// What a user says about the cell and the phases of a stack to be tracked: the file CELL.toml, and options
/// that take precedence over it.

#include <array>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "imaging/cell/cell.hpp"
#include "imaging/stack/chosen_frames.hpp"
#include "imaging/track/link_detections.hpp"

namespace twincell::imaging {

/// The options that state the source of the phases.
struct PhaseRequest {
  std::string phase_lock;          ///< frames per cycle, "found", "none", or a list of triggers (*.csv)
  std::optional<double> drive_hz;  ///< frequency of the drive, for a list of triggers in seconds
};

/// The options of `track` that describe the cell. Absent values are those of the file.
struct TrackRequest {
  std::string cell_file;                        ///< CELL.toml; empty: no file
  std::vector<std::string> assignments;         ///< "section.key=value", override the file
  std::optional<double> pixels_per_sigma;       ///< camera pixels per bead diameter
  std::optional<std::array<double, 2>> origin;  ///< lower left inside corner, px
  std::optional<double> width, height;          ///< of the cell, sigma
  std::optional<double> gamma, amplitude;       ///< of the drive; amplitude in sigma
  std::optional<int> frames_per_cycle;          ///< 0: not phase-locked
  std::optional<int> first_phase;               ///< phase of the first frame
  PhaseRequest phase;
};

/// The cell description of the file, with the other members taking precedence. Two quantities determine the
/// drive: if `gamma` or `amplitude` is given, the drive of the file is used only for these two.
/// \throws InputError, ConfigError as read_cell, and for contradictions
CellDescription resolve_cell(const TrackRequest& request);

/// Where the phases come from, and the phase lock of the stack.
struct StatedPhases {
  PhaseSource source;
  PhaseLock lock;
};
/// The phases according to PhaseRequest::phase_lock: N, found, none, or a list of triggers. N and none
/// override the lock of the cell.
/// \param cell_file for messages
/// \throws ConfigError for another word, or a frequency that is not used or contradicts the cell
StatedPhases stated_phases(const PhaseRequest& request, const CellDescription& cell,
                           const std::string& cell_file);

/// The phase lock of the chosen frames of a stack with the given lock.
/// \throws ConfigError if the step does not divide the frames per cycle
PhaseLock lock_of_chosen(PhaseLock lock, const FrameRange& range);

}  // namespace twincell::imaging
