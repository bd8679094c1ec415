#pragma once
/// \file
/// Options of the verbs that determine the drive phase of each frame: track and match.

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "imaging/cell/cell.hpp"
#include "imaging/track/link_detections.hpp"

namespace CLI {
class App;
}

namespace twincell::cli {

/// The options.
struct PhaseFlags {
  std::string phase_lock;
  std::optional<double> drive_hz;
};
/// Adds --phase-lock and --drive-hz.
void add_phase_flags(CLI::App& verb, PhaseFlags& flags);
/// Source of the phases according to --phase-lock: N, found, none, or a list of triggers. N and none are
/// stored in `cell`. \param cell_file for messages \throws ConfigError for another word, or a frequency that
/// is not used or contradicts the cell
PhaseSource phase_source(const PhaseFlags& flags, CellDescription& cell, const std::string& cell_file);

/// The phases of a stack for the user, as one line of text and as JSON.
std::string phases_in_words(const PhaseTable& phases);
nlohmann::json json_of(const PhaseTable& phases);

}  // namespace twincell::cli
