#include "imaging/settings/settings_doubts.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

#include "imaging/settings/settings_choice.hpp"

namespace twincell::imaging {

namespace {

/// "round regions: 64 px wide at (150, 190), ...", the largest first.
std::string regions_text(const std::vector<LargerDisc>& discs) {
  constexpr std::size_t kMost = 5;
  std::string text = "round regions larger than the beads:";
  for (std::size_t k = 0; k < std::min(kMost, discs.size()); ++k)
    text += fmt::format("{} {:.0f} px wide at ({:.0f}, {:.0f})", k > 0 ? "," : "", discs[k].diameter_px,
                        discs[k].x, discs[k].y);
  return discs.size() > kMost ? text + fmt::format(" and {} more", discs.size() - kMost) : text;
}

/// What spots that come in pairs are taken for.
std::string pairs_text(const SettingsChoice& choice, const std::string& refine) {
  const double apart = std::hypot(choice.pairs->dx_px, choice.pairs->dy_px);
  return choice.beads_of_pairs
             ? fmt::format(
                   "spots that come in pairs, {:.1f} px apart in one direction, are taken for two highlights "
                   "of each bead, as of two lamps; if each spot is a bead, locate them with {}",
                   apart, options_text(choice.tried[1].settings, refine))
             : fmt::format(
                   "the discs come in pairs, {:.1f} px apart in one direction, as two highlights of each "
                   "bead do: then each bead, {:.1f} px wide if they touch, is located twice; use one lamp, "
                   "or compare the overlay of twincell locate --overlay with that of --diameter {:.1f} "
                   "--refine profile",
                   apart, choice.pairs->touching_px, choice.pairs->touching_px);
}

}  // namespace

std::string options_text(const FoundSettings& settings, const std::string& refine) {
  std::string text = fmt::format("--diameter {:.2f}", settings.diameter_px);
  for (const double other : settings.other_diameters_px) text += fmt::format(" {:.2f}", other);
  text += settings.bright ? " --bright" : " --dark";
  const std::string& method = settings.method.empty() ? refine : settings.method;
  return text + " --refine " + method;
}

std::vector<std::string> settings_doubts(const SettingsChoice& choice, const std::string& refine) {
  std::vector<std::string> doubts;
  if (const std::size_t k = narrow_runner_up(choice); k > 0 && !choice.pairs)
    doubts.push_back(
        fmt::format("other settings explain the picture nearly as well; compare the overlays of twincell "
                    "locate --overlay without options and with {}",
                    options_text(choice.tried[k].settings, refine)));
  if (choice.uncovered_lattice_px > 0)
    doubts.push_back(fmt::format(
        "the picture repeats itself every {0:.1f} px, as a crystal of beads of this diameter does, but the "
        "beads found cover little of it: compare the overlay of twincell locate --overlay with and without "
        "--diameter {0:.1f} --dark or --bright",
        choice.uncovered_lattice_px));
  if (choice.pairs) doubts.push_back(pairs_text(choice, refine));
  if (choice.apart_px > 0)
    doubts.push_back(fmt::format(
        "no two of the discs, which are {:.1f} px wide, are closer than {:.1f} px: they may be the "
        "highlights of larger beads; compare the overlay of twincell locate --overlay with that of "
        "--diameter {:.1f}",
        choice.tried.front().rim_px, choice.apart_px, choice.apart_px));
  if (choice.spots_px > 0 && choice.apart_px <= 0)
    doubts.push_back(fmt::format(
        "the discs are {:.1f} px wide: discs this small may be highlights of larger beads, or gaps "
        "between them; check the overlay of twincell locate --overlay, and give the diameter of "
        "larger beads with --diameter",
        choice.spots_px));
  if (choice.touching_px > 0)
    doubts.push_back(fmt::format(
        "the located discs are {:.1f} px wide, but most are {:.1f} px from their nearest neighbour, as beads "
        "of that width that touch: the rims of shaded beads are found too far inside; compare the overlay of "
        "twincell locate --overlay with that of --diameter {:.1f}",
        choice.tried.front().rim_px, choice.touching_px, choice.touching_px));
  if (choice.one_sided > 0)
    doubts.push_back(fmt::format(
        "the beads are lit from one side: their rims are {:.0f} % of their contrast brighter there than in "
        "the mean. All centres are shifted towards the light by more than their stated errors; displacements "
        "are right. Light the beads evenly, or from behind",
        100 * choice.one_sided));
  if (!choice.larger.empty()) {
    const LargerDisc& largest = choice.larger.front();
    doubts.push_back(fmt::format(
        "no bead explains {}: if they are beads, locate each size with a table of its own, the "
        "largest with --diameter {:.0f} {} --refine edges",
        regions_text(choice.larger), largest.diameter_px, largest.bright ? "--bright" : "--dark"));
  }
  constexpr double kSaturated = 0.1;
  if (choice.saturated > kSaturated)
    doubts.push_back(
        fmt::format("{:.0f} % of the pixels have the brightest grey level: the light saturates the camera, "
                    "which moves rims and edges inwards; expose less",
                    100 * choice.saturated));
  const auto more = std::find_if(choice.tried.begin(), choice.tried.end(), [&](const TriedSettings& t) {
    return !is_round(t) && t.evidence > choice.tried.front().evidence;
  });
  // In a packing, light from one side makes discs of several sizes seem other than round.
  if (more != choice.tried.end())
    doubts.push_back(
        "objects that are not round explain more of the picture than the beads do: check the overlay of "
        "twincell locate --overlay" +
        (more->settings.method.empty() && !more->settings.other_diameters_px.empty()
             ? fmt::format(", and compare it with that of {}, if the beads are shaded and of several sizes",
                           options_text(more->settings, refine))
             : "; --explain lists them"));
  return doubts;
}

}  // namespace twincell::imaging
