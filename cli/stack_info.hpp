#pragma once
/// \file
/// Opening a stack of frames, and its description for `info`.

#include <filesystem>
#include <memory>
#include <nlohmann/json.hpp>
#include <string>

#include "imaging/stack/open_frames.hpp"

namespace twincell::cli {

struct Common;

/// Calls open_frames() and prints the notes of the stack on stderr.
std::unique_ptr<imaging::FrameSource> open_stack(const std::filesystem::path& stack, const Common& common);

/// Whether a file is an HDF5 file with a group h5md. A file named .h5 that is not HDF5 also counts, so that
/// the reader of trajectories refuses it with its own message.
bool is_trajectory(const std::filesystem::path& file);

/// Format, size, number of frames, bit depth, times, and grey values of the first frame.
/// \throws InputError as open_frames()
nlohmann::json describe_stack(const std::filesystem::path& stack);
/// The description of describe_stack() as lines of text.
std::string stack_as_text(const nlohmann::json& description);

}  // namespace twincell::cli
