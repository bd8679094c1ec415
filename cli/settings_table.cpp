#include "cli/settings_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "imaging/settings/settings_choice.hpp"
#include "imaging/settings/settings_doubts.hpp"

namespace twincell::cli {

namespace {

bool diameter_found(const imaging::LocatorOptions& given) {
  return given.diameter_px <= 0;
}
bool polarity_found(const imaging::LocatorOptions& given) {
  return !given.polarity_known;
}
/// Darkness is in units of a part of the light.
bool pale(const imaging::LocatorOptions& locator) {
  return locator.preprocess.contrast < 1 && imaging::model_of(locator.refine) != imaging::DiscModel::circle;
}

}  // namespace

std::string found_settings_text(const imaging::LocatorOptions& given, const imaging::LocatorOptions& locator,
                                std::int64_t frame, const std::string& evidence) {
  const std::string shown = frame == 0 ? "the first frame" : fmt::format("frame {}", frame);
  const imaging::DiscModel model = imaging::model_of(locator.refine);
  const bool model_found = given.refine.method != locator.refine.method;
  std::string text;
  if (diameter_found(given)) {
    std::string sizes = fmt::format("{:.2f}", locator.diameter_px);
    for (const double other : locator.other_diameters_px) sizes += fmt::format(" and {:.2f}", other);
    text += fmt::format("bead diameter found from {}: {} px (--diameter)\n", shown, sizes);
  }
  text += evidence;
  if (model_found && model == imaging::DiscModel::circle)
    text += fmt::format(
        "the insides of the discs differ in {}: the discs are fitted by their rims (--refine edges)\n",
        shown);
  if (model_found && model == imaging::DiscModel::shared_profile)
    text += fmt::format(
        "the discs are alike but not plain in {}: they are fitted by their common profile (--refine "
        "profile)\n",
        shown);
  if (pale(locator))
    text += fmt::format("beads are pale: darkness is in units of {:.2f} of the light\n",
                        locator.preprocess.contrast);
  if (!polarity_found(given)) return text;
  // Discs with a common profile may have rings of both kinds.
  if (model == imaging::DiscModel::shared_profile)
    return text + fmt::format("frames are read as with --{}, which explains {} better (--dark, --bright)\n",
                              locator.preprocess.bright ? "bright" : "dark", shown);
  return text + fmt::format("beads are {} than the background in {} (--dark, --bright)\n",
                            locator.preprocess.bright ? "brighter" : "darker", shown);
}

nlohmann::json found_settings_as_json(const imaging::LocatorOptions& given,
                                      const imaging::LocatorOptions& locator, std::int64_t frame) {
  nlohmann::json found = {{"diameter_px", locator.diameter_px},
                          {"refine", locator.refine.method},
                          {"bright", locator.preprocess.bright}};
  if (!locator.other_diameters_px.empty()) found["other_diameters_px"] = locator.other_diameters_px;
  if (pale(locator)) found["contrast"] = locator.preprocess.contrast;
  if (diameter_found(given) || polarity_found(given)) found["settings_frame"] = frame;
  return found;
}

std::string settings_table(const imaging::SettingsChoice& choice, const std::string& refine) {
  const bool chosen = !choice.tried.empty();
  const std::vector<imaging::TriedSettings>& all = chosen ? choice.tried : choice.refused;
  if (all.empty()) return "no settings were tried: diameter and polarity are given, or nothing is seen\n";
  double most = 0;
  for (const imaging::TriedSettings& t : all) most = std::max(most, t.evidence);
  std::string text = "evidence/nats   share  beads  settings\n";
  for (const imaging::TriedSettings& t : all)
    text += fmt::format("{:13.0f}  {:6.3f}  {:5}  {}{}\n", t.evidence, most > 0 ? t.evidence / most : 0.0,
                        t.beads, imaging::options_text(t.settings, refine),
                        chosen && &t == &all.front() ? "  (chosen)"
                        : t.not_chosen.empty()       ? ""
                                                     : "  (" + t.not_chosen + ")");
  return chosen ? text + settings_lead(choice, refine) : text;
}

std::string settings_lead(const imaging::SettingsChoice& choice, const std::string& refine) {
  const std::size_t k = imaging::runner_up(choice);
  if (k == 0 && choice.suffices)
    return "they explain nearly all of the picture: no others can explain clearly more\n";
  if (k == 0)
    return choice.tried.size() > 1 ? "the other settings describe the same discs, or some of them\n"
                                   : "no other settings explain a part of the picture\n";
  const double lead = choice.tried.front().evidence - choice.tried[k].evidence;
  const std::string other = imaging::options_text(choice.tried[k].settings, refine);
  if (lead < 0)
    return fmt::format("the best settings with other discs have {:.0f} nats more, but {}: {}\n", -lead,
                       choice.tried[k].not_chosen, other);
  return fmt::format("the best settings with other discs have {:.0f} nats less: {}\n", lead, other);
}

std::string settings_warnings(const imaging::SettingsChoice& choice, const std::string& refine) {
  std::string text;
  for (const std::string& doubt : imaging::settings_doubts(choice, refine)) text += doubt + "\n";
  return text;
}

nlohmann::json settings_as_json(const imaging::SettingsChoice& choice, const std::string& refine) {
  nlohmann::json list = nlohmann::json::array();
  for (const imaging::TriedSettings& t : choice.tried.empty() ? choice.refused : choice.tried)
    list.push_back({{"options", imaging::options_text(t.settings, refine)},
                    {"evidence", t.evidence},
                    {"beads", t.beads},
                    {"rim_variation", t.rim_variation},
                    {"rim_shift", t.rim_shift},
                    {"not_chosen", t.not_chosen},
                    {"chosen", !choice.tried.empty() && &t == &choice.tried.front()}});
  return list;
}

}  // namespace twincell::cli
