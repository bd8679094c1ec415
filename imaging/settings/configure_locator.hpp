#pragma once
/// \file
/// Completes the locator options of a stack: those given, plus the settings found from its first frames.

#include <cstdint>
#include <string>
#include <utility>

#include "core/error.hpp"
#include "imaging/locate/locator.hpp"
#include "imaging/settings/found_settings.hpp"
#include "imaging/stack/frames_ahead.hpp"

namespace twincell::imaging {

/// Complete options, the frame from which the open settings were found, and the settings tried on it.
struct LocatorConfiguration {
  LocatorOptions locator;
  std::int64_t frame = 0;
  SettingsChoice choice;  ///< the settings that were tried on that frame; empty: none were
};

/// A stack shows no discs from which a diameter could be estimated.
class NoDiscs : public InputError {
 public:
  NoDiscs(const Where& where, const std::string& complaint, SettingsChoice choice)
      : InputError(where, complaint), choice_(std::move(choice)) {}
  /// The settings that were tried on a frame, none chosen.
  [[nodiscard]] const SettingsChoice& choice() const { return choice_; }

 private:
  SettingsChoice choice_;
};

/// Finds the settings that `given` leaves open (diameter, polarity and, with the default refiner, the disc
/// model) from the first of frames 0, 1, 2, 4, ... 32 that shows beads (auto_configuration.hpp), or from a
/// later one: if two later frames, at most 16 frames on, agree on other discs, theirs are taken. If both
/// diameter and polarity are given, only the contrast is found, from the first frame.
/// \throws NoDiscs if no frame shows discs
/// \param threads which do not change the result
LocatorConfiguration configure_locator(FramesAhead& frames, const LocatorOptions& given, int threads = 1);

}  // namespace twincell::imaging
