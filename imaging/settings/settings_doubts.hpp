#pragma once
/// \file
/// What is doubtful about the settings that were chosen for a stack, in sentences.

#include <string>
#include <vector>

#include "imaging/settings/found_settings.hpp"

namespace twincell::imaging {

/// The options that select settings: "--diameter 14.00 --dark --refine profile".
/// \param refine the refiner of settings that name none
std::string options_text(const FoundSettings& settings, const std::string& refine);

/// A sentence with the options of the runner-up if the chosen settings won narrowly (narrow_runner_up), and a
/// sentence each if a crystal is not covered, if the discs may be the highlights of larger beads or gaps, if
/// beads that touch are wider than the discs, if all beads are lit from one side, if the light saturates the
/// camera, and if objects that are not round explain more of the picture than the chosen discs. Empty if
/// there is no reason for doubt. Without a full stop.
std::vector<std::string> settings_doubts(const SettingsChoice& choice, const std::string& refine);

}  // namespace twincell::imaging
