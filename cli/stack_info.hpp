#pragma once
/// \file
/// What a stack of frames holds, for `info` and for those who open one.

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "imaging/stack/open_frames.hpp"

namespace CLI {
class App;
}

namespace twincell::cli {

struct Common;

/// open_frames(), with the stack's notes on stderr.
std::unique_ptr<FrameSource> open_stack(const std::filesystem::path& stack, const Common& common);

/// Likewise, each frame divided by a flat field (flat_field.hpp). \param flat  "": none; "stack": from the
/// stack itself; else a stack of the cell without beads
std::unique_ptr<FrameSource> open_flattened(const std::filesystem::path& stack, const std::string& flat,
                                            const Common& common);
/// The option --flat, of the verbs that locate.
void add_flat_option(CLI::App& verb, std::string& flat);
/// \throws ConfigError for a flat field from the light between beads that are brighter than what lies behind
/// them
void check_flat(const std::string& flat, bool bright);

/// An HDF5 file with a group h5md; what is named .h5 and is no HDF5 counts as one too, to be refused as such.
bool is_trajectory(const std::filesystem::path& file);

/// Format, size, frames, depth, times, and the values of the first frame. \throws InputError as open_frames()
nlohmann::json describe_stack(const std::filesystem::path& stack);
std::string stack_as_text(const nlohmann::json& description);

}  // namespace twincell::cli
