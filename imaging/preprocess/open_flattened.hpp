#pragma once
/// \file
/// Opens a stack whose frames are divided by a flat field.

#include <filesystem>
#include <memory>
#include <string>

#include "imaging/stack/frame_source.hpp"

namespace twincell::imaging {

/// `frames`, each divided by a flat field (flat_field.hpp).
/// \param stack name of the stack, which is read again for its own flat field
/// \param flat "": no flat field; "stack": computed from the stack itself; otherwise a stack of the cell
/// without beads
/// \throws InputError as open_frames, flat_of_blank, flat_of_stack
std::unique_ptr<FrameSource> flattened_by(std::unique_ptr<FrameSource> frames,
                                          const std::filesystem::path& stack, const std::string& flat);

/// \throws ConfigError for --flat stack if the beads are brighter than the background: this flat field is the
/// light between dark beads
void check_flat(const std::string& flat, bool bright);

}  // namespace twincell::imaging
