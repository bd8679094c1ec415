#pragma once
/// \file
/// The settings that were tried on a stack, as a table and as JSON.

#include <cstdint>
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "imaging/locate/locator.hpp"
#include "imaging/settings/found_settings.hpp"

namespace twincell::cli {

/// One line for each of the settings: evidence, its share of the largest, number of beads, options. The
/// chosen ones come first. Below it, by how much they won over the best settings with other discs. If none
/// were chosen, those that were refused, with the reasons.
std::string settings_table(const imaging::SettingsChoice& choice, const std::string& refine);

/// By how much the chosen settings won over the best ones with other discs, in a sentence.
/// \pre choice.tried is not empty
std::string settings_lead(const imaging::SettingsChoice& choice, const std::string& refine);

/// imaging::settings_doubts, one a line. Empty if there is no reason for doubt.
std::string settings_warnings(const imaging::SettingsChoice& choice, const std::string& refine);

/// What was found in the frames, in sentences that name the options: diameters, model, contrast and polarity.
/// \param given what the user gave
/// \param locator complete options
/// \param frame number of the frame that showed the settings
/// \param evidence table or warnings, placed after the diameters
std::string found_settings_text(const imaging::LocatorOptions& given, const imaging::LocatorOptions& locator,
                                std::int64_t frame, const std::string& evidence);

/// The same as members "diameter_px", "refine", "bright" and, where they apply, "other_diameters_px",
/// "contrast" and "settings_frame".
nlohmann::json found_settings_as_json(const imaging::LocatorOptions& given,
                                      const imaging::LocatorOptions& locator, std::int64_t frame);

/// List of objects with "options", "evidence", "beads" and "chosen"; in the order of the table.
nlohmann::json settings_as_json(const imaging::SettingsChoice& choice, const std::string& refine);

}  // namespace twincell::cli
