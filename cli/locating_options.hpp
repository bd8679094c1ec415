#pragma once
/// \file
/// Options of the verbs that locate beads: locate, track and match have the same.

#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "imaging/locate/locator.hpp"
#include "imaging/phase/phase_lock.hpp"
#include "imaging/preprocess/region.hpp"
#include "imaging/stack/chosen_frames.hpp"

namespace CLI {
class App;
}

namespace twincell::cli {

struct Common;

/// The options.
struct LocatingFlags {
  std::vector<double> diameters;
  bool dark = false;
  LocatorOptions locator;
  std::string flat, background, roi, mask, frames;
};
/// Adds them to a verb.
void add_locating_flags(CLI::App& verb, LocatingFlags& flags);

/// The locator's options. \param scale_px bead diameter if no --diameter is given \param bright_known
/// polarity that the cell states; absent: unknown
LocatorOptions locator_of(const LocatingFlags& flags, std::optional<double> scale_px = {},
                          std::optional<bool> bright = {});
/// The part of the picture by --roi and --mask. \throws ConfigError if --roi cannot be read, InputError if
/// --mask cannot
Region region_of(const LocatingFlags& flags);
/// The frames chosen by --frames. \throws ConfigError if the text cannot be read
FrameRange frames_of(const LocatingFlags& flags);
/// Opens the stack with --frames, --flat and --background applied, and prints its notes.
/// \param locator as locator_of returned it
std::unique_ptr<FrameSource> open_for_locating(const std::string& stack, const LocatingFlags& flags,
                                               const LocatorOptions& locator, const Common& common);
/// \throws ConfigError for --flat stack if the beads turned out brighter than the background
void check_locating(const LocatingFlags& flags, bool bright);
/// The options that restrict what is read, for the provenance of the result; null if there are none.
nlohmann::json restrictions(const LocatingFlags& flags);
/// The phase lock of the chosen frames of a stack with the given lock. \throws ConfigError if the step does
/// not divide the frames per cycle
PhaseLock lock_of_chosen(PhaseLock lock, const FrameRange& range);

}  // namespace twincell::cli
