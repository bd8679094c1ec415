#include "cli/settings_table.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <nlohmann/json.hpp>

#include "imaging/settings/settings_choice.hpp"

namespace twincell::cli {

std::string options_of(const imaging::FoundSettings& settings, const std::string& refine) {
  std::string text = fmt::format("--diameter {:.2f}", settings.diameter_px);
  for (const double other : settings.other_diameters_px) text += fmt::format(" {:.2f}", other);
  text += settings.bright ? " --bright" : " --dark";
  const std::string& method = settings.method.empty() ? refine : settings.method;
  return text + " --refine " + method;
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
                        t.beads, options_of(t.settings, refine),
                        chosen && &t == &all.front() ? "  (chosen)"
                        : t.not_chosen.empty()       ? ""
                                                     : "  (" + t.not_chosen + ")");
  return chosen ? text + settings_lead(choice, refine) : text;
}

std::string settings_lead(const imaging::SettingsChoice& choice, const std::string& refine) {
  const std::size_t k = imaging::runner_up(choice);
  if (k == 0) return "no other discs were considered\n";
  const double lead = choice.tried.front().evidence - choice.tried[k].evidence;
  const std::string other = options_of(choice.tried[k].settings, refine);
  if (lead < 0)
    return fmt::format("the best settings with other discs have {:.0f} nats more, but {}: {}\n", -lead,
                       choice.tried[k].not_chosen, other);
  return fmt::format("the best settings with other discs have {:.0f} nats less: {}\n", lead, other);
}

std::string settings_warnings(const imaging::SettingsChoice& choice, const std::string& refine) {
  std::string text;
  if (const std::size_t k = imaging::narrow_runner_up(choice); k > 0)
    text += fmt::format("other settings explain the picture nearly as well; compare --overlay with: {}\n",
                        options_of(choice.tried[k].settings, refine));
  if (std::any_of(choice.tried.begin(), choice.tried.end(), [&](const imaging::TriedSettings& t) {
        return !imaging::is_round(t) && t.evidence > choice.tried.front().evidence;
      }))
    text +=
        "objects that are not round explain more of the picture than the beads do: check --overlay; "
        "--explain lists them\n";
  return text;
}

nlohmann::json settings_as_json(const imaging::SettingsChoice& choice, const std::string& refine) {
  nlohmann::json list = nlohmann::json::array();
  for (const imaging::TriedSettings& t : choice.tried.empty() ? choice.refused : choice.tried)
    list.push_back({{"options", options_of(t.settings, refine)},
                    {"evidence", t.evidence},
                    {"beads", t.beads},
                    {"rim_variation", t.rim_variation},
                    {"rim_shift", t.rim_shift},
                    {"not_chosen", t.not_chosen},
                    {"chosen", !choice.tried.empty() && &t == &choice.tried.front()}});
  return list;
}

}  // namespace twincell::cli
