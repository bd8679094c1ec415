#pragma once
/// \file
/// Options of the verbs that determine the drive phase of each frame: track and match.

#include <nlohmann/json.hpp>
#include <string>

#include "imaging/phase/phase_lock.hpp"
#include "imaging/track/track_request.hpp"

namespace CLI {
class App;
}

namespace twincell::cli {

/// Adds --phase-lock and --drive-hz.
void add_phase_options(CLI::App& verb, imaging::PhaseRequest& request);

/// The phases of a stack for the user, in one line of text.
std::string phases_in_words(const imaging::PhaseTable& phases);
/// The same as JSON.
nlohmann::json json_of(const imaging::PhaseTable& phases);

}  // namespace twincell::cli
