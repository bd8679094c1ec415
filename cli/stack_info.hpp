#pragma once
/// \file
/// Opening a stack of frames, and its description for `info`.

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

/// Calls open_frames() and prints the notes of the stack on stderr.
std::unique_ptr<FrameSource> open_stack(const std::filesystem::path& stack, const Common& common);

/// As open_stack(), with each frame divided by a flat field (open_flattened.hpp).
std::unique_ptr<FrameSource> open_flattened(const std::filesystem::path& stack, const std::string& flat,
                                            const Common& common);
/// Adds the option --flat to a verb that locates beads.
void add_flat_option(CLI::App& verb, std::string& flat);

/// Whether a file is an HDF5 file with a group h5md. A file named .h5 that is not HDF5 also counts, so that
/// the reader of trajectories refuses it with its own message.
bool is_trajectory(const std::filesystem::path& file);

/// Format, size, number of frames, bit depth, times, and grey values of the first frame. \throws InputError
/// as open_frames()
nlohmann::json describe_stack(const std::filesystem::path& stack);
std::string stack_as_text(const nlohmann::json& description);

}  // namespace twincell::cli
