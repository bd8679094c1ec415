#pragma once
/// \file
/// A user's statements about the beads of a stack and the part of it that is searched. `locate`, `track` and
/// `match` have the same options.

#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "imaging/locate/locator.hpp"
#include "imaging/preprocess/region.hpp"
#include "imaging/settings/found_settings.hpp"
#include "imaging/stack/chosen_frames.hpp"

namespace twincell::imaging {

/// The options as the user gives them; empty: not given.
struct LocatingRequest {
  LocatorOptions locator;         ///< its diameters are those of `diameters`
  std::vector<double> diameters;  ///< px, up to 8; empty: from the scale of the cell, else from the frames
  bool refine_given = false;      ///< the refiner of `locator` is the user's, not the default
  bool dark = false;              ///< the beads are darker than the background
  std::string flat;               ///< flat field (open_flattened.hpp)
  std::string background;         ///< picture of the cell without beads
  std::string roi;                ///< "left,top,width,height", px
  std::string mask;               ///< picture that is 0 where nothing is searched
  std::string frames;             ///< "A:B" or "A:B:STEP"
};

/// The locator's options.
/// \param scale_px bead diameter if none is requested; absent: determined from the frames
/// \param bright polarity that the cell states; absent: unknown
/// \param refine refiner that the cell states, used if none is requested
LocatorOptions locator_of(const LocatingRequest& request, std::optional<double> scale_px = {},
                          std::optional<bool> bright = {}, const std::optional<std::string>& refine = {});
/// The part of the picture.
/// \throws ConfigError if `roi` cannot be read, InputError if `mask` cannot
Region region_of(const LocatingRequest& request);
/// The chosen frames.
/// \throws ConfigError if the text cannot be read
FrameRange frames_of(const LocatingRequest& request);
/// The chosen frames of an open stack, with flat field or background applied.
/// \param stack name of the stack, which is read again for its own flat field; empty for frames in memory
/// \param locator as locator_of returned it
/// \throws InputError, ConfigError
std::unique_ptr<FrameSource> prepare_frames(std::unique_ptr<FrameSource> frames, const std::string& stack,
                                            const LocatingRequest& request, const LocatorOptions& locator);
/// An option of a request as the user would write it.
struct GivenOption {
  std::string name;                 ///< "--roi"
  std::vector<std::string> values;  ///< none: a flag
  bool of_discs = false;            ///< says what the discs are; otherwise, where and how they are searched
};
/// The options that differ from their defaults.
std::vector<GivenOption> given_options(const LocatingRequest& request);
/// The first of them that says how the beads of frames are located, which is any but one diameter; empty if
/// none is given.
std::string option_for_frames(const LocatingRequest& request);
/// A frame that was located in a region, with positions in the whole picture and without discs that the mask
/// cuts.
Located in_whole_picture(Located located, const Region& region);
/// The same for the larger discs of a choice.
SettingsChoice in_whole_picture(SettingsChoice choice, const Region& region);
/// The options that restrict or change what is read, for the record of the result; null if there are none.
nlohmann::json restrictions(const LocatingRequest& request);

}  // namespace twincell::imaging
